// Light or dark colours: those of the system, until the user selects the others.
const system = matchMedia("(prefers-color-scheme: dark)");

export function startTheme(button, changed) {
  let chosen = localStorage.getItem("jbf-theme");
  const apply = () => {
    const dark = chosen ? chosen === "dark" : system.matches;
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    button.textContent = dark ? "Light" : "Dark";
  };
  button.addEventListener("click", () => {
    chosen = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    localStorage.setItem("jbf-theme", chosen);
    apply(); changed();
  });
  system.addEventListener("change", () => { apply(); changed(); });
  apply();
}
