//! One of the targets, which `STRAT_TARGET` names, under libFuzzer.

#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::LazyLock;

static TARGET: LazyLock<fn(&[u8])> = LazyLock::new(|| {
    let name = std::env::var("STRAT_TARGET").expect("STRAT_TARGET names a target");
    let found = strat_fuzz::TARGETS.iter().find(|(known, _)| *known == name);
    found.unwrap_or_else(|| panic!("no target is called {name}")).1
});

fuzz_target!(|data: &[u8]| (*TARGET)(data));
