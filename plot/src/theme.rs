//! Every colour of figures and pages, in one place.

use std::fmt::Write as _;

use crate::figure::Colour;

/// Light ink on dark ground, or dark ink on light ground.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Theme {
    /// Dark ink on white.
    Light,
    /// Light ink on dark grey.
    Dark,
}

/// Meaning of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Behind a page.
    Ground,
    /// Behind a figure.
    Panel,
    /// Text.
    Ink,
    /// Text that stands back: numbers of the axes.
    Soft,
    /// Grid lines.
    Grid,
    /// The frame of a panel.
    Frame,
    /// A colour of curves.
    Curve(Colour),
    /// Holds.
    Good,
    /// Fails.
    Bad,
    /// Neither holds nor fails.
    Neutral,
}

/// Red, green and blue.
pub type Rgb = (u8, u8, u8);

/// A role with its colours, as 0xRRGGBB.
struct Row {
    role: Role,
    /// Name of its custom property in CSS.
    name: &'static str,
    /// On light ground.
    light: u32,
    /// On dark ground.
    dark: u32,
}

const fn row(role: Role, name: &'static str, light: u32, dark: u32) -> Row {
    Row { role, name, light, dark }
}

/// The numbered colours are those of Okabe and Ito ("Color universal design", 2008), which people with any colour vision can tell
/// apart, darkened on white and lightened on dark ground until each has a contrast of at least 3 : 1.
const TABLE: [Row; 16] = [
    row(Role::Ground, "ground", 0xff_ff_ff, 0x12_18_1f),
    row(Role::Panel, "panel", 0xff_ff_ff, 0x18_20_29),
    row(Role::Ink, "ink", 0x1b_27_33, 0xe4_ea_f0),
    row(Role::Soft, "soft", 0x5b_6b_7a, 0x9f_b0_bf),
    row(Role::Grid, "grid", 0xe3_e8_ee, 0x2a_35_40),
    row(Role::Frame, "frame", 0x9a_a8_b5, 0x5a_6b_7a),
    row(Role::Curve(Colour::First), "c1", 0x00_72_b2, 0x5a_b8_f0),
    row(Role::Curve(Colour::Second), "c2", 0xd5_5e_00, 0xff_93_50),
    row(Role::Curve(Colour::Third), "c3", 0x00_9e_73, 0x3f_d0_a0),
    row(Role::Curve(Colour::Fourth), "c4", 0xb0_60_9a, 0xe3_a1_cd),
    row(Role::Curve(Colour::Fifth), "c5", 0xc9_8a_00, 0xef_c0_4f),
    row(Role::Curve(Colour::Sixth), "c6", 0x56_b4_e9, 0xa8_dc_ff),
    row(Role::Curve(Colour::Muted), "c7", 0x87_94_a1, 0x8c_9c_ab),
    row(Role::Good, "good", 0x00_75_4f, 0x49_d3_a2),
    row(Role::Bad, "bad", 0xb8_43_0a, 0xff_9a_62),
    row(Role::Neutral, "none", 0x6b_7a_89, 0x93_a3_b2),
];

impl Theme {
    /// Returns the colour of a role.
    pub fn colour(self, role: Role) -> Rgb {
        let found = TABLE.iter().find(|row| row.role == role);
        let value = found.map_or(0, |row| self.value(row));
        ((value >> 16) as u8, (value >> 8) as u8, value as u8)
    }

    /// Returns the colour of a role as `#rrggbb`.
    pub fn hex(self, role: Role) -> String {
        let (red, green, blue) = self.colour(role);
        format!("#{red:02x}{green:02x}{blue:02x}")
    }

    /// Returns the custom properties of CSS that hold the theme, for the root of a page.
    pub fn properties(self) -> String {
        let mut text = String::new();
        for row in &TABLE {
            // writing to a string cannot fail
            let _ = write!(text, "--{}:{};", row.name, self.hex(row.role));
        }
        format!(":root{{{text}}}")
    }

    fn value(self, row: &Row) -> u32 {
        match self {
            Theme::Light => row.light,
            Theme::Dark => row.dark,
        }
    }
}

impl Role {
    /// Returns the role's custom property in CSS, such as `var(--ink)`.
    pub fn variable(self) -> String {
        let name = TABLE.iter().find(|row| row.role == self).map_or("ink", |row| row.name);
        format!("var(--{name})")
    }
}

/// Fonts of a figure's text, the first that the reader has.
pub(crate) const FONTS: &str = "system-ui,'Segoe UI','DejaVu Sans',sans-serif";
