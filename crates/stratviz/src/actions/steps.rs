//! Commands that step from what is shown to what is next to it.

use super::{Now, is_patterns};
use crate::command::Command;
use crate::panels::inside::step_count;
use crate::panels::patterns::MOST_POINTS;
use crate::state::{InsideWords, Page, PatternWords, PictureWords, TheoryWords};
use stratcore::integrand::CATALOGUE;
use stratcore::sampler::{CountPolicy, count_used};
use stratcore::study::SamplerChoice;

/// Moves the first pixel; on the patterns page the arrows have other work.
pub(super) fn move_pixel(now: &Now<'_>, by: [i64; 2]) -> Option<Command> {
    (!is_patterns(now)).then_some(Command::Move(by))
}

/// Exposes by so many stops more.
pub(super) fn expose(now: &Now<'_>, stops: f64) -> Command {
    let exposure = now.state.picture.exposure + stops;
    Command::SetPicture(PictureWords { exposure, ..now.state.picture.clone() })
}

/// The next N inside the pixel, or of the patterns.
pub(super) fn count(now: &Now<'_>, up: bool) -> Option<Command> {
    let state = now.state;
    step(
        now,
        |words| words.n = step_count(words.n, up),
        |words| words.n = step_admitted(state.pattern_sampler(), words.n, words.dim, up),
    )
}

/// The next of the chosen samplers.
pub(super) fn sampler(now: &Now<'_>, forward: bool) -> Option<Command> {
    let names = &now.state.study.samplers;
    let by = if forward { 1 } else { names.len().checked_sub(1)? };
    let after = |place: usize| names.get((place + by) % names.len().max(1)).cloned();
    let inside = match names.iter().position(|name| *name == now.state.inside.sampler) {
        Some(place) => after(place)?,
        None => names.first()?.clone(),
    };
    let pattern = after(now.state.pattern_place())?;
    step(now, |words| words.sampler = inside, |words| words.sampler = pattern)
}

/// The next trial.
pub(super) fn trial(now: &Now<'_>, forward: bool) -> Option<Command> {
    let next = |trial: u32| {
        if forward { trial.saturating_add(1) } else { trial.saturating_sub(1) }
    };
    step(now, |words| words.trial = next(words.trial), |words| words.trial = next(words.trial))
}

/// Changes the inside of the pixel, or the patterns, whichever is seen.
fn step(
    now: &Now<'_>,
    inside: impl FnOnce(&mut InsideWords),
    patterns: impl FnOnce(&mut PatternWords),
) -> Option<Command> {
    match now.state.page {
        Page::Pixel => {
            let mut words = now.state.inside.clone();
            inside(&mut words);
            Some(Command::SetInside(words))
        }
        Page::Patterns => {
            let mut words = now.state.patterns.clone();
            patterns(&mut words);
            Some(Command::SetPatterns(words))
        }
        Page::Theory | Page::Trade => None,
    }
}

/// The next d that the patterns or the integrand has.
pub(super) fn dimension(now: &Now<'_>, up: bool) -> Option<Command> {
    let next = |dim: usize, [least, most]: [usize; 2]| {
        let next = if up { dim + 1 } else { dim.checked_sub(1)? };
        (least..=most).contains(&next).then_some(next)
    };
    match now.state.page {
        Page::Patterns => {
            let words = &now.state.patterns;
            let dim = next(words.dim, PatternWords::DIMENSIONS)?;
            Some(Command::SetPatterns(words.clone().in_dim(dim)))
        }
        Page::Theory => {
            let words = &now.state.theory;
            let info = CATALOGUE.iter().find(|info| info.name == words.name)?;
            let dim = next(words.dim, TheoryWords::dimensions(info))?;
            Some(Command::SetTheory(TheoryWords { dim, ..words.clone() }))
        }
        Page::Pixel | Page::Trade => None,
    }
}

/// The next pair of dimensions.
pub(super) fn axes(now: &Now<'_>, forward: bool) -> Option<Command> {
    several_pairs(now).map(|words| {
        let axes = words.axes_beside(forward);
        Command::SetPatterns(PatternWords { axes, all_pairs: false, ..words.clone() })
    })
}

/// Every pair of dimensions, or one.
pub(super) fn all_pairs(now: &Now<'_>) -> Option<Command> {
    several_pairs(now).map(|words| {
        Command::SetPatterns(PatternWords { all_pairs: !words.all_pairs, ..words.clone() })
    })
}

fn several_pairs<'a>(now: &Now<'a>) -> Option<&'a PatternWords> {
    Some(&now.state.patterns).filter(|words| is_patterns(now) && words.dim > 2)
}

/// The next larger or smaller N that a sampler has.
pub fn step_admitted(sampler: &str, n: u64, dim: usize, up: bool) -> u64 {
    let Ok(SamplerChoice { sampler, .. }) = SamplerChoice::named(sampler) else { return n };
    let used = |n| count_used(sampler, n, dim, CountPolicy::Snap).ok();
    let Some(now) = used(n) else { return n };
    let is_next = |m: &u64| if up { *m > now } else { *m < now };
    let next = if up {
        (n + 1..=MOST_POINTS).filter_map(used).find(is_next)
    } else {
        (1..n).rev().filter_map(used).find(is_next)
    };
    next.unwrap_or(now)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn n_steps_through_what_the_sampler_has() {
        let up = |name, n| step_admitted(name, n, 2, true);
        let down = |name, n| step_admitted(name, n, 2, false);
        assert_eq!((up("jittered", 256), down("jittered", 256)), (289, 225));
        assert_eq!((up("random", 256), down("random", 1)), (257, 1));
        assert_eq!((up("oa", 25), down("oa", 49)), (49, 25));
        // From an N that is snapped, to the neighbours of what is shown.
        assert_eq!(up("jittered", 250), 289);
        assert_eq!(up("jittered", MOST_POINTS), MOST_POINTS);
    }
}
