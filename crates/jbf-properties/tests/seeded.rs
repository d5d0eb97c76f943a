//! Tests of every property with random inputs from known seeds; a failure prints its seed.
//!
//! | variable | meaning |
//! | --- | --- |
//! | `JBF_SEED=NUMBER` | this seed alone |
//! | `JBF_SEED_FROM=NUMBER` | begin at another seed |
//! | `JBF_EACH=NUMBER` | inputs of each property |
//! | `JBF_ALL=1` | millions of inputs, as in `make test-extended`, instead of 200,000 |

use jbf_properties::{all_seen, Entry, ALL};
use rand_pcg::rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::panic::{catch_unwind, resume_unwind};
use std::time::Instant;

/// Longest input, bytes; it is sufficient for several dozen steps.
const LONGEST: usize = 512;

/// Fills the buffer with the input of a seed and returns it; most inputs are short, some are long.
fn input(seed: u64, buffer: &mut [u8; LONGEST]) -> &[u8] {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let longest = LONGEST >> (random.next_u32() % 4);
    let length = longest / 2 + random.next_u32() as usize % (longest / 2);
    let bytes = &mut buffer[..length];
    random.fill_bytes(bytes);
    bytes
}

fn number(variable: &str) -> Option<u64> {
    let text = std::env::var(variable).ok()?;
    Some(text.parse().expect("a number"))
}

/// Number of inputs of all properties together without `JBF_ALL=1`.
const FAST_CASES: u64 = 200_000;

/// Number of inputs of one property: all with `JBF_ALL=1`, otherwise a part of [`FAST_CASES`].
fn usual_cases(entry: &Entry) -> u64 {
    let all = u64::from(entry.thousands) * 1000;
    if number("JBF_ALL") == Some(1) {
        return all;
    }
    let thousands: u32 = ALL.iter().map(|p| p.thousands).sum();
    all * FAST_CASES / (u64::from(thousands) * 1000)
}

fn try_all(name: &str) {
    let entry: &Entry = ALL.iter().find(|p| p.name == name).expect("a property");
    let seeds = match number("JBF_SEED") {
        Some(one) => one..one + 1,
        None => {
            let from = number("JBF_SEED_FROM").unwrap_or(0);
            let cases = number("JBF_EACH").unwrap_or_else(|| usual_cases(entry));
            from..from + cases
        }
    };
    let mut buffer = [0; LONGEST];
    let (before, begun, cases) = (all_seen(), Instant::now(), seeds.end - seeds.start);
    for seed in seeds {
        let bytes = input(seed, &mut buffer);
        let holds = || {
            let _ = (entry.holds)(&mut arbitrary::Unstructured::new(bytes));
        };
        if let Err(why) = catch_unwind(holds) {
            eprintln!("{name} does not hold: JBF_SEED={seed}");
            resume_unwind(why);
        }
    }
    let steps = all_seen() - before;
    let took = begun.elapsed().as_secs_f64();
    println!("{name}: {cases} inputs, {steps} steps, {took:.1} s");
    // A property that checks nothing would also hold.
    assert!(cases == 1 || steps > 2 * cases, "{name}: {steps} steps");
}

macro_rules! tests {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            try_all(stringify!($name));
        })*

        #[test]
        fn every_property_has_a_seeded_test() {
            assert_eq!(ALL.len(), [$(stringify!($name)),*].len());
            let thousands: u32 = ALL.iter().map(|p| p.thousands).sum();
            assert!(thousands >= 1000, "{thousands} thousand");
        }
    };
}

tests! { law film chain plant encoder observers controller interface driver }
