//! Pasted lines of any kind: opened, or refused in words.

#[path = "../../../tests/hostile/mutate.rs"]
mod mutate;

use mutate::Mutator;
use std::path::Path;
use stratviz::line;
use stratviz::state::State;

fn open(data: &[u8]) -> bool {
    let text = String::from_utf8_lossy(data);
    match line::open(&text, &State::default()) {
        Ok(state) => {
            // What was opened can be copied.
            let [x, y] = state.pixels.first().copied().unwrap_or_default();
            for words in [
                line::pixel(&state, [x, y], state.study.trials),
                line::integrand(&state.theory, &state.study, state.study.trials),
                line::points(&state),
                line::spectrum(&state),
                line::discrepancy(&state),
                line::render(&state),
            ] {
                assert!(line::line(&words).starts_with("stratcli "));
            }
            true
        }
        Err(fault) => {
            assert!(!fault.trim().is_empty() && !fault.contains('\n'), "{fault:?}");
            false
        }
    }
}

#[test]
fn pasted_lines_are_opened_or_refused_in_words() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/lines");
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let corpus: Vec<_> = paths.iter().map(|path| std::fs::read(path).unwrap()).collect();
    let opened = corpus.iter().filter(|data| open(data)).count();
    assert!(opened >= 4, "{opened} of {} lines", corpus.len());
    let mut mutator = Mutator::new(&corpus, 1996, 3);
    let opened = (0..20_000).filter(|_| open(&mutator.next())).count();
    assert!(opened > 100, "{opened}");
}
