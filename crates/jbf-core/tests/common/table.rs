//! Comma-separated reference tables, included at compile time.

/// Returns the rows of a table after its header, as numbers.
pub fn rows<const N: usize>(text: &str) -> Vec<[f64; N]> {
    text.lines()
        .skip(1)
        .map(|line| {
            let cells: Vec<f64> = line
                .split(',')
                .map(|c| c.trim().parse().expect("a number"))
                .collect();
            <[f64; N]>::try_from(cells).expect("a full row")
        })
        .collect()
}
