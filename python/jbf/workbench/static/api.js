// Asking the server: every request carries the token that came with the address.

const fromAddress = new URLSearchParams(location.hash.slice(1)).get("token");
if (fromAddress) {
  sessionStorage.setItem("jbf-token", fromAddress);
  history.replaceState(null, "", location.pathname);
}
const headers = { "X-JBF-Token": sessionStorage.getItem("jbf-token") ?? "" };

async function answered(response) {
  if (response.ok) return response;
  const text = await response.text();
  let words = text;
  try { words = JSON.parse(text).error; } catch { /* plain words */ }
  throw new Error(words);
}

// Requests that are under way; the page is told when one takes longer than BUSY_AFTER_MS.
const BUSY_AFTER_MS = 300, pending = new Set();
let tell = () => {};
export const onBusy = (told) => { tell = told; };
export const cancelRequests = () => { for (const control of pending) control.abort(); };

// The result of `send()`, which `control.abort()` cancels.
async function tracked(control, send) {
  pending.add(control);
  const timer = setTimeout(() => tell(true), BUSY_AFTER_MS);
  try { return await send(); } finally {
    clearTimeout(timer); pending.delete(control);
    if (!pending.size) tell(false);
  }
}

function request(address, options) {
  const control = new AbortController();
  return tracked(control, async () => answered(await fetch(address, { ...options, headers, signal: control.signal })));
}

export async function get(name, parameters = {}) {
  const query = new URLSearchParams();
  for (const [key, value] of Object.entries(parameters)) {
    if (value !== null && value !== undefined) query.set(key, value);
  }
  return (await request(`/api/${name}?${query}`, {})).json();
}

export async function post(name, parameters = {}) {
  return (await request(`/api/${name}`, { method: "POST", body: JSON.stringify(parameters) })).json();
}

// `progress(share)` is called with the share that was sent. XMLHttpRequest, since fetch reports no progress.
export function upload(file, progress) {
  const request = new XMLHttpRequest();
  return tracked(request, () => new Promise((resolve, reject) => {
    request.open("POST", `/api/upload?name=${encodeURIComponent(file.name)}`);
    for (const [name, value] of Object.entries(headers)) request.setRequestHeader(name, value);
    request.upload.onprogress = (event) => { if (event.lengthComputable && file.size > 1e7) progress(event.loaded / event.total); };
    request.onabort = () => reject(new DOMException("", "AbortError"));
    request.onerror = () => reject(new Error(`${file.name}: the connection was lost`));
    request.onload = () => {
      let answer = {};
      try { answer = JSON.parse(request.responseText); } catch { answer = { error: request.responseText }; }
      if (request.status === 200) resolve(answer); else reject(new Error(answer.error));
    };
    request.send(file);
  }));
}

// A text as a file of the browser's own.
export async function download(what, name) {
  const response = await request(`/api/text?what=${what}`, {});
  const link = document.createElement("a");
  link.href = URL.createObjectURL(await response.blob());
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}

// The state whenever it changes; begins anew where the line breaks.
export async function follow(received, lost) {
  for (;;) {
    try {
      const response = await answered(await fetch("/api/events", { headers }));
      const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
      let rest = "";
      for (;;) {
        const { value, done } = await reader.read();
        if (done) break;
        const parts = (rest + value).split("\n\n");
        rest = parts.pop();
        for (const part of parts) if (part.startsWith("data: ")) received(JSON.parse(part.slice(6)));
      }
      lost("The server has stopped: start jbf workbench again.");
    } catch (error) { lost(error.message); }
    await new Promise((resolve) => setTimeout(resolve, 2000));
  }
}
