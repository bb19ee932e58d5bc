//! Pages to read: what all of them share.

/// The style of every page.
const STYLE: &str = include_str!("page.css");

/// Text in which nothing is taken for markup.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A page that holds everything it shows. `title` is plain text, `body` markup.
pub(crate) fn page(title: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\n\
         <title>{}</title>\n<style>\n{STYLE}</style></head><body>\n{body}</body></html>\n",
        escaped(title)
    )
}

/// What a page says of the scene besides: its notes.
pub(crate) fn notes(notes: &[String]) -> String {
    notes.iter().map(|note| format!("<p class=\"note\">{}</p>\n", escaped(note))).collect()
}
