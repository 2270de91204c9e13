//! The style sheet of a page with figures in it.

use std::fmt::Write as _;

use crate::ink::Ink;
use crate::theme::{FONTS, Theme};

/// Returns the style that a page with inline figures carries: both themes as custom properties, chosen by the reader's setting, and
/// the classes of everything that figures draw.
pub fn style_sheet() -> String {
    let (light, dark) = (Theme::Light.properties(), Theme::Dark.properties());
    let mut text = format!("{light}\n@media (prefers-color-scheme:dark){{{dark}}}\n");
    let _ = writeln!(text, ".fig{{font-family:{FONTS};font-size:12px}}");
    for ink in Ink::all() {
        let _ = writeln!(text, ".fig .{}{{{}}}", ink.class(), ink.declarations());
    }
    text
}
