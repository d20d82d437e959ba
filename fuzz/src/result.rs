//! Results of earlier maps, which `study` and `map --resume` read back.

use serde::Deserialize;
use stratcli::report::comparison::{self, Scene};
use stratcore::map::{Header, Summary};

/// `MAP.json`, as far as it is read.
#[derive(Deserialize)]
struct Found {
    #[serde(flatten)]
    header: Header,
    #[serde(flatten)]
    summary: Option<Summary>,
}

/// The summary of a map, compared with itself.
pub fn summary(data: &[u8]) {
    let Ok(found) = serde_json::from_slice::<Found>(data) else { return };
    let Some(summary) = found.summary else { return };
    let scene =
        || Scene { header: found.header.clone(), summary: summary.clone(), picture: String::new() };
    let scenes = [scene(), scene()];
    comparison::text(&scenes);
    comparison::render("study", &scenes);
}
