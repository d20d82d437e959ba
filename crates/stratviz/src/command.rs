//! What a panel asks for; [`App`](crate::app::App) does it after drawing.

use crate::state::{
    InsideWords, Layout, Page, PatternWords, PictureWords, StudyWords, TheoryWords, TradeWords,
};
use std::path::PathBuf;

/// What has to be answered with a line of text first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// Which scene is to be opened?
    Open,
    /// To which file does the picture go?
    SavePicture,
    /// To which file do the page's curves go?
    SaveCurve,
    /// To which file do the discrepancies go?
    SaveDiscrepancies,
    /// Which lines of `stratcli` are to be opened?
    OpenLine,
}

/// How the picture is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// The whole of it.
    Fit,
    /// One point per pixel.
    OneToOne,
    /// Enlarged.
    Closer,
    /// Smaller.
    Farther,
}

/// A wish of the user.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Open a scene: a path or a built-in name.
    Open(String),
    /// Load the scene's files again.
    Reload,
    /// Study this pixel, and no other.
    Study([u32; 2]),
    /// Study this pixel beside the others.
    Compare([u32; 2]),
    /// No longer study this pixel.
    Remove([u32; 2]),
    /// Move the first pixel by this much.
    Move([i64; 2]),
    /// Study in another way.
    SetStudy(StudyWords),
    /// Show the picture in another way.
    SetPicture(PictureWords),
    /// Expose so that the brightest value is white.
    Normalise,
    /// Look at the picture in another way.
    Look(Look),
    /// Show another trial inside the pixel.
    SetInside(InsideWords),
    /// Study another integrand.
    SetTheory(TheoryWords),
    /// Trade in another way.
    SetTrade(TradeWords),
    /// Show other point sets.
    SetPatterns(PatternWords),
    /// Share the window out in another way.
    SetLayout(Layout),
    /// Stop every study, transform and trade.
    Stop,
    /// Start what the page shows again, from its first trial.
    Restart,
    /// Drop the curves of samplers that are no longer studied.
    ForgetKept,
    /// Study every pixel of the picture.
    StartMap,
    /// Stop doing so; what was finished stays.
    CancelMap,
    /// Measure error against time.
    Trade,
    /// Turn to a page.
    ShowPage(Page),
    /// Dark or light.
    SetDark(bool),
    /// Put the command lines of what is on screen into the clipboard.
    CopyLine,
    /// Put this into the clipboard.
    CopyText(String),
    /// Open what a line of `stratcli` says.
    OpenLine(String),
    /// Write the picture: `.png` or `.exr`.
    SavePicture(PathBuf),
    /// Write the curves of the page: `.svg`, `.png` or `.csv`.
    SaveCurve(PathBuf),
    /// Write the discrepancies of the patterns page: `.svg`, `.png` or `.csv`.
    SaveDiscrepancies(PathBuf),
    /// Show or hide the grids of strata.
    ShowStrata(bool),
    /// Ask for a line of text.
    Ask(Question),
    /// Show every key.
    ShowHelp,
    /// Show every command.
    ShowPalette,
    /// Close the window.
    Quit,
}
