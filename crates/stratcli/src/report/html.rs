//! What all pages have in common.

use super::page::{self, Figure};
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A whole page that carries everything: a heading, the paragraph below it, and the rest.
pub fn page(title: &str, lead: &Markup, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(include_str!("page.css"))) }
            }
            body { main {
                header {
                    h1 { (title) }
                    p.lead { (lead) }
                }
                (body)
                footer { "stratcli " (env!("CARGO_PKG_VERSION")) }
            } }
        }
    };
    page.into_string()
}

/// A figure with its caption, of a class of `page.css`.
pub fn figure(figure: &Figure, class: &str) -> Markup {
    html! {
        figure id=(figure.name) class=(class) {
            (PreEscaped(&figure.inline))
            figcaption { (figure.caption) }
        }
    }
}

/// How to make a page again; `report` if the paper's page lies beside it.
pub fn made_again(command: &str, seed: u64, report: bool) -> Markup {
    html! {
        h2 { "Made again by" }
        p { code { (command) } }
        p { "Seed " (seed) ". The same seed gives the same numbers on any number of threads." }
        @if report {
            p { a href=(page::NAME) { "The paper's own figures" } " are beside this page." }
        }
    }
}
