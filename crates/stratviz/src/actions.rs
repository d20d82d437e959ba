//! Everything that has a key or a place in a menu: one table, from which menus, keys, help,
//! palette and the hints of buttons are made.

mod choices;
mod steps;
mod trigger;

pub use choices::{Entry, built_in, entries, overlays, recent};
pub use steps::step_admitted;
pub use trigger::Trigger;

use crate::command::{Command, Look, Question};
use crate::model::Model;
use crate::state::{Page, PictureWords, State};
use eframe::egui::{Button, Key, Ui};
use trigger::{ctrl, ctrl_shift, key, on, shift};

/// What an action is asked about: the window as it is.
#[derive(Clone, Copy)]
pub struct Now<'a> {
    /// What is remembered.
    pub state: &'a State,
    /// What was computed.
    pub model: &'a Model,
    /// The pixel under the pointer.
    pub hovered: Option<[u32; 2]>,
}

/// Something that can be asked for by name.
#[derive(Debug, Clone, Copy)]
pub struct Action {
    /// On buttons and in menus.
    pub name: &'static str,
    /// What it does.
    pub about: &'static str,
    /// The menu that has it.
    pub menu: Menu,
    /// Keys that ask for it.
    pub triggers: &'static [Trigger],
    /// What it asks for now; none where there is nothing to ask for.
    pub command: fn(&Now<'_>) -> Option<Command>,
}

/// The menus.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Menu {
    /// Scenes, files, the clipboard.
    File,
    /// Studied pixels and their curves.
    Study,
    /// The picture and what lies over it.
    Picture,
    /// Point sets, inside a pixel and by themselves.
    Points,
    /// Pages and the window.
    View,
}

impl Menu {
    /// In their order in the bar, each with its name.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::File, "File"),
        (Self::Study, "Study"),
        (Self::Picture, "Picture"),
        (Self::Points, "Points"),
        (Self::View, "View"),
    ];

    /// What it holds.
    pub fn actions(self) -> impl Iterator<Item = &'static Action> {
        ALL.iter().filter(move |action| action.menu == self)
    }
}

impl Action {
    /// The keys that ask for it on this page; on any where there is none.
    pub fn keys(&self, page: Option<Page>) -> String {
        let here = |trigger: &&Trigger| page.is_none_or(|page| trigger.is_on(page));
        let words = self.triggers.iter().filter(here).map(|trigger| trigger.words(page.is_none()));
        words.collect::<Vec<_>>().join(", ")
    }

    /// What it does, and its keys.
    pub fn hint(&self, page: Page) -> String {
        match self.keys(Some(page)) {
            keys if keys.is_empty() => self.about.to_owned(),
            keys => format!("{} ({keys})", self.about),
        }
    }

    /// A button, grey where there is nothing to ask for.
    pub fn button(&self, ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
        self.place(ui, now, Button::new(self.name), self.hint(now.state.page))
    }

    /// An entry of a menu.
    pub fn menu_entry(&self, ui: &mut Ui, now: &Now<'_>) -> Option<Command> {
        let button = Button::new(self.name).shortcut_text(self.keys(Some(now.state.page)));
        self.place(ui, now, button, self.about.to_owned())
    }

    fn place(
        &self,
        ui: &mut Ui,
        now: &Now<'_>,
        button: Button<'_>,
        hint: String,
    ) -> Option<Command> {
        let command = (self.command)(now);
        let button = ui.add_enabled(command.is_some(), button);
        command.filter(|_| button.on_hover_text(hint).clicked())
    }
}

/// Names each action and lists them all.
macro_rules! table {
    ($($id:ident, $menu:ident, $name:literal, $about:literal, [$($trigger:expr),*], $command:expr;)*) => {
        $(
            #[doc = $about]
            pub const $id: Action = Action {
                name: $name,
                about: $about,
                menu: Menu::$menu,
                triggers: &[$($trigger),*],
                command: $command,
            };
        )*
        /// The table. Of two actions with one key the first that has something to ask for wins.
        pub const ALL: &[Action] = &[$($id),*];
    };
}

table! {
    OPEN, File, "Open…", "open a scene: a file, or a built-in name", [ctrl(Key::O)],
        |_| Some(Command::Ask(Question::Open));
    RELOAD, File, "Reload", "load the scene's files again", [key(Key::F5)],
        |_| Some(Command::Reload);
    SAVE_PICTURE, File, "Save picture…", "write the picture as PNG or OpenEXR", [ctrl(Key::S)],
        |now| now.model.loaded.as_ref().map(|_| Command::Ask(Question::SavePicture));
    SAVE_CURVE, File, "Save curves…", "write the page's curves as CSV, SVG or PNG", [ctrl(Key::E)],
        |_| Some(Command::Ask(Question::SaveCurve));
    SAVE_DISCREPANCIES, File, "Save discrepancies…",
        "write the discrepancies as CSV, SVG or PNG", [ctrl_shift(Key::E)],
        |now| is_patterns(now).then_some(Command::Ask(Question::SaveDiscrepancies));
    COPY_LINE, File, "Copy as command", "copy the stratcli line that gives the numbers on screen",
        [key(Key::C)], |_| Some(Command::CopyLine);
    OPEN_LINE, File, "Open a command…", "show what a copied line of stratcli says",
        [Trigger::PASTE], |_| Some(Command::Ask(Question::OpenLine));
    COPY_PIXEL, File, "Copy x,y", "copy the pixel under the pointer, or the studied one",
        [Trigger::COPY], |now| {
            let [x, y] = now.hovered.or(now.state.pixels.first().copied())?;
            Some(Command::CopyText(format!("{x},{y}")))
        };
    QUIT, File, "Quit", "close the window", [ctrl(Key::Q)], |_| Some(Command::Quit);

    STOP, Study, "Stop", "stop what is under way and keep the curves as they are",
        [key(Key::Space)], |now| is_busy(now).then_some(Command::Stop);
    RESTART, Study, "Run again", "run the page's work from its first trial", [key(Key::Space)],
        |now| (!is_busy(now)).then_some(Command::Restart);
    MEASURE, Study, "Measure",
        "measure errors on all cores, then times on one: nothing else should run meanwhile", [],
        |now| {
            let can = now.model.loaded.is_some() && crate::line::trade(now.state).is_some();
            (can && now.state.page == Page::Trade && !now.model.trade.progress.is_running())
                .then_some(Command::Trade)
        };
    FORGET_KEPT, Study, "Forget kept curves", "drop curves of samplers that are switched off", [],
        |now| {
            let is_any = now.model.studies.iter().any(|study| !study.kept.is_empty());
            is_any.then_some(Command::ForgetKept)
        };
    LEFT, Study, "Pixel left", "study the pixel to the left", [key(Key::ArrowLeft)],
        |now| steps::move_pixel(now, [-1, 0]);
    RIGHT, Study, "Pixel right", "study the pixel to the right", [key(Key::ArrowRight)],
        |now| steps::move_pixel(now, [1, 0]);
    UP, Study, "Pixel up", "study the pixel above", [key(Key::ArrowUp)],
        |now| steps::move_pixel(now, [0, -1]);
    DOWN, Study, "Pixel down", "study the pixel below", [key(Key::ArrowDown)],
        |now| steps::move_pixel(now, [0, 1]);
    FAR_LEFT, Study, "10 left", "study the 10th pixel to the left", [shift(Key::ArrowLeft)],
        |now| steps::move_pixel(now, [-10, 0]);
    FAR_RIGHT, Study, "10 right", "study the 10th pixel to the right", [shift(Key::ArrowRight)],
        |now| steps::move_pixel(now, [10, 0]);
    FAR_UP, Study, "10 up", "study the 10th pixel above", [shift(Key::ArrowUp)],
        |now| steps::move_pixel(now, [0, -10]);
    FAR_DOWN, Study, "10 down", "study the 10th pixel below", [shift(Key::ArrowDown)],
        |now| steps::move_pixel(now, [0, 10]);

    FIT, Picture, "Fit", "show the whole picture", [key(Key::F)], |_| Some(Command::Look(Look::Fit));
    ONE_TO_ONE, Picture, "1:1", "show one point per pixel", [ctrl(Key::Num0)],
        |_| Some(Command::Look(Look::OneToOne));
    CLOSER, Picture, "Closer", "enlarge the picture", [key(Key::Plus)],
        |_| Some(Command::Look(Look::Closer));
    FARTHER, Picture, "Farther", "make the picture smaller", [key(Key::Minus)],
        |_| Some(Command::Look(Look::Farther));
    BRIGHTER, Picture, "Brighter", "expose half a stop more", [key(Key::E)],
        |now| Some(steps::expose(now, 0.5));
    DARKER, Picture, "Darker", "expose half a stop less", [shift(Key::E)],
        |now| Some(steps::expose(now, -0.5));
    NORMALISE, Picture, "Normalise", "expose so that the brightest value is white", [key(Key::A)],
        |now| now.model.loaded.as_ref().map(|_| Command::Normalise);
    NEXT_OVERLAY, Picture, "Next overlay", "show the next map over the picture", [key(Key::O)],
        |now| {
            let overlay = now.state.picture.overlay.next();
            Some(Command::SetPicture(PictureWords { overlay, ..now.state.picture.clone() }))
        };
    MAP, Picture, "Map", "study every pixel under jittered, coarse to fine", [key(Key::M)],
        |now| {
            let can = now.model.loaded.is_some() && !now.model.map_progress.is_running();
            can.then_some(Command::StartMap)
        };
    CANCEL_MAP, Picture, "Cancel map", "end the map and keep what is finished", [key(Key::M)],
        |now| now.model.map_progress.is_running().then_some(Command::CancelMap);

    MORE, Points, "More samples", "show the next larger N",
        [key(Key::N), on(Page::Patterns, Key::ArrowRight)], |now| steps::count(now, true);
    FEWER, Points, "Fewer samples", "show the next smaller N",
        [shift(Key::N), on(Page::Patterns, Key::ArrowLeft)], |now| steps::count(now, false);
    NEXT_SAMPLER, Points, "Next sampler", "show the points of the next sampler",
        [key(Key::S), on(Page::Patterns, Key::ArrowDown)], |now| steps::sampler(now, true);
    SAMPLER_BEFORE, Points, "Sampler before", "show the points of the sampler before",
        [shift(Key::S), on(Page::Patterns, Key::ArrowUp)], |now| steps::sampler(now, false);
    NEXT_TRIAL, Points, "Next trial", "show the points of the next trial", [key(Key::T)],
        |now| steps::trial(now, true);
    TRIAL_BEFORE, Points, "Trial before", "show the points of the trial before", [shift(Key::T)],
        |now| steps::trial(now, false);
    MORE_DIMENSIONS, Points, "More dimensions", "raise d of the points, or of the integrand",
        [key(Key::D)], |now| steps::dimension(now, true);
    FEWER_DIMENSIONS, Points, "Fewer dimensions", "lower d of the points, or of the integrand",
        [shift(Key::D)], |now| steps::dimension(now, false);
    NEXT_AXES, Points, "Next axes", "show the next pair of dimensions", [key(Key::V)],
        |now| steps::axes(now, true);
    AXES_BEFORE, Points, "Axes before", "show the pair of dimensions before", [shift(Key::V)],
        |now| steps::axes(now, false);
    ALL_PAIRS, Points, "All pairs", "show every pair of dimensions, or one", [key(Key::P)],
        |now| steps::all_pairs(now);
    STRATA, Points, "Strata", "show or hide the grid of strata", [key(Key::G)], |now| {
        let is_seen = matches!(now.state.page, Page::Pixel | Page::Patterns);
        is_seen.then_some(Command::ShowStrata(!now.state.strata))
    };

    PIXEL, View, "Pixel page", "show the curves of the studied pixels", [key(Key::Num1)],
        |_| Some(Command::ShowPage(Page::Pixel));
    THEORY, View, "Theory page", "show integrands with known answers", [key(Key::Num2)],
        |_| Some(Command::ShowPage(Page::Theory));
    TRADE, View, "Trade page", "show error against time", [key(Key::Num3)],
        |_| Some(Command::ShowPage(Page::Trade));
    PATTERNS, View, "Patterns page", "show point sets by themselves", [key(Key::Num4)],
        |_| Some(Command::ShowPage(Page::Patterns));
    DARK, View, "Dark or light", "change the colours of the window", [key(Key::L)],
        |now| Some(Command::SetDark(!now.state.dark));
    PALETTE, View, "Commands…", "find any command by its name", [ctrl_shift(Key::P)],
        |_| Some(Command::ShowPalette);
    HELP, View, "Keys…", "list every key", [key(Key::H), key(Key::F1)], |_| Some(Command::ShowHelp);
}

fn is_busy(now: &Now<'_>) -> bool {
    now.model.is_busy_on(now.state.page)
}

fn is_patterns(now: &Now<'_>) -> bool {
    now.state.page == Page::Patterns
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Progress;
    use crate::state::InsideWords;

    /// Windows that differ in what can be asked for.
    fn windows() -> Vec<(State, Model)> {
        let mut all = Vec::new();
        for (page, _) in Page::ALL {
            for is_busy in [false, true] {
                let mut state = State { page, pixels: vec![[3, 4]], ..State::default() };
                state.patterns = state.patterns.in_dim(5);
                let mut model = Model::default();
                model.theory.running = is_busy;
                if is_busy {
                    model.map_progress = Progress::Running(0.5);
                }
                all.push((state, model));
            }
        }
        all
    }

    #[test]
    fn a_key_asks_for_one_thing() {
        for (state, model) in windows() {
            let now = Now { state: &state, model: &model, hovered: None };
            let mut seen: Vec<(Trigger, &str)> = Vec::new();
            for action in ALL.iter().filter(|action| (action.command)(&now).is_some()) {
                for trigger in action.triggers.iter().filter(|t| t.is_on(state.page)) {
                    let other = seen.iter().find(|(known, _)| known.is_same_key(trigger));
                    assert_eq!(other, None, "{} on {:?}", action.name, state.page);
                    seen.push((*trigger, action.name));
                }
            }
            assert!(seen.len() > 15);
        }
    }

    #[test]
    fn names_are_different_and_each_is_in_one_menu() {
        let in_menus: usize = Menu::ALL.iter().map(|(menu, _)| menu.actions().count()).sum();
        assert_eq!(in_menus, ALL.len());
        for (i, action) in ALL.iter().enumerate() {
            assert!(ALL[..i].iter().all(|other| other.name != action.name), "{}", action.name);
            assert!(!action.about.is_empty());
        }
    }

    #[test]
    fn keys_are_written_as_they_are_pressed() {
        assert_eq!(PALETTE.keys(None), "Ctrl+Shift+P");
        assert_eq!(MORE.keys(None), "N, Right (Patterns)");
        assert_eq!(MORE.keys(Some(Page::Pixel)), "N");
        assert_eq!(MORE.keys(Some(Page::Patterns)), "N, Right");
        assert_eq!(COPY_PIXEL.hint(Page::Pixel).rsplit(' ').next(), Some("(Ctrl+C)"));
        assert_eq!(MEASURE.hint(Page::Trade), MEASURE.about);
    }

    #[test]
    fn an_action_steps_what_the_page_shows() {
        let mut state = State { page: Page::Patterns, ..State::default() };
        let model = Model::default();
        let ask = |action: &Action, state: &State| {
            (action.command)(&Now { state, model: &model, hovered: None })
        };
        assert_eq!(ask(&ALL_PAIRS, &state), None);
        assert_eq!(ask(&LEFT, &state), None);
        let Some(Command::SetPatterns(words)) = ask(&MORE_DIMENSIONS, &state) else { panic!() };
        assert_eq!(words.dim, 3);
        state.patterns = words;
        for axes in [[0, 2], [1, 2], [0, 1]] {
            let Some(Command::SetPatterns(words)) = ask(&NEXT_AXES, &state) else { panic!() };
            assert_eq!(words.axes, axes);
            state.patterns = words;
        }
        state.page = Page::Theory;
        let Some(Command::SetTheory(words)) = ask(&FEWER_DIMENSIONS, &state) else {
            // form-factor exists in 4 dimensions alone.
            assert_eq!(state.theory.name, "form-factor");
            return;
        };
        panic!("{words:?}");
    }

    #[test]
    fn every_inside_step_keeps_to_the_chosen_samplers() {
        let state = State::default();
        let model = Model::default();
        let now = Now { state: &state, model: &model, hovered: None };
        let Some(Command::SetInside(InsideWords { sampler, .. })) = (NEXT_SAMPLER.command)(&now)
        else {
            panic!()
        };
        assert_eq!(sampler, "sobol");
    }
}
