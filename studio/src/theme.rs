//! One small system of colours, type sizes and distances, dark and light.

use crate::command::DesignSlot;
use crate::design_overlays::MOST_OVERLAYS;
use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Visuals};

/// Distances in points: everything is a multiple of the smallest.
pub mod space {
    /// Between parts of a group.
    pub const SMALL: f32 = 4.0;
    /// Between widgets.
    pub const MEDIUM: f32 = 8.0;
    /// Between groups.
    pub const LARGE: f32 = 16.0;
}

/// Colours by what they mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindowTheme {
    /// Behind everything.
    pub ground: Color32,
    /// A card or a panel on it.
    pub card: Color32,
    /// A field that can be changed.
    pub field: Color32,
    /// Lines between groups.
    pub line: Color32,
    /// Grid of a plot.
    pub grid: Color32,
    /// Text.
    pub text: Color32,
    /// Secondary text.
    pub weak: Color32,
    /// Selected handle, and handles that can be dragged.
    pub accent: Color32,
    /// A requirement that holds.
    pub good: Color32,
    /// A requirement that fails, and errors.
    pub bad: Color32,
    /// Stale results, and warnings.
    pub warn: Color32,
    /// Curves, distinguishable without red and green.
    pub curves: [Color32; 4],
    /// Kept designs A, B and C.
    pub kept: [Color32; 3],
    /// Named designs that are drawn over the current one.
    pub overlays: [Color32; MOST_OVERLAYS],
}

const fn rgb(value: u32) -> Color32 {
    Color32::from_rgb((value >> 16) as u8, (value >> 8) as u8, value as u8)
}

/// The theme for a dark room.
pub const DARK: WindowTheme = WindowTheme {
    ground: rgb(0x12_15_1a),
    card: rgb(0x1a_1e_25),
    field: rgb(0x25_2b_34),
    line: rgb(0x2c_33_3d),
    grid: rgb(0x2a_30_3a),
    text: rgb(0xd9_de_e6),
    weak: rgb(0x8b_95_a3),
    accent: rgb(0x4d_a3_ff),
    good: rgb(0x4c_c3_8a),
    bad: rgb(0xf2_6d_6d),
    warn: rgb(0xe6_b3_4d),
    curves: [rgb(0x4d_a3_ff), rgb(0xf2_9f_4b), rgb(0x7c_d4_b5), rgb(0xc0_9b_f2)],
    kept: [rgb(0xe8_7b_b0), rgb(0xb9_c9_4e), rgb(0x9a_b4_d6)],
    overlays: [rgb(0xf4_d3_5e), rgb(0x5f_d0_e8), rgb(0xe8_80_66), rgb(0x9b_d8_6a), rgb(0xd9_a8_f0)],
};

/// The theme for a bright room.
pub const LIGHT: WindowTheme = WindowTheme {
    ground: rgb(0xf2_f4_f7),
    card: rgb(0xff_ff_ff),
    field: rgb(0xe9_ed_f2),
    line: rgb(0xd8_de_e6),
    grid: rgb(0xe4_e8_ee),
    text: rgb(0x1d_24_2e),
    weak: rgb(0x62_6d_7b),
    accent: rgb(0x0b_6b_cb),
    good: rgb(0x1a_85_55),
    bad: rgb(0xc6_35_35),
    warn: rgb(0x9a_6a_00),
    curves: [rgb(0x0b_6b_cb), rgb(0xc7_66_0a), rgb(0x12_8a_6b), rgb(0x7a_4f_c4)],
    kept: [rgb(0xb8_35_7a), rgb(0x6b_7a_00), rgb(0x4a_6a_94)],
    overlays: [rgb(0x8f_6a_00), rgb(0x00_7c_94), rgb(0xa8_43_2a), rgb(0x4b_7d_1e), rgb(0x8a_3f_a6)],
};

impl WindowTheme {
    /// Applies the theme to a window.
    pub fn apply(&self, ctx: &egui::Context) {
        let dark = *self == DARK;
        ctx.set_theme(if dark { egui::Theme::Dark } else { egui::Theme::Light });
        let visuals = self.visuals(if dark { Visuals::dark() } else { Visuals::light() });
        ctx.all_styles_mut(|style| {
            style.visuals = visuals.clone();
            style.text_styles = sizes();
            style.spacing.item_spacing = egui::vec2(space::MEDIUM, space::SMALL);
            style.spacing.button_padding = egui::vec2(space::MEDIUM, 3.0);
            style.spacing.interact_size.y = 22.0;
            style.animation_time = 0.08;
        });
    }

    fn visuals(&self, mut v: Visuals) -> Visuals {
        (v.panel_fill, v.window_fill, v.extreme_bg_color, v.faint_bg_color) =
            (self.ground, self.card, self.card, self.field);
        v.text_edit_bg_color = Some(self.field);
        v.override_text_color = Some(self.text);
        v.weak_text_color = Some(self.weak);
        // a blinking cursor would draw frames while nothing changes
        v.text_cursor.blink = false;
        v.window_stroke = Stroke::new(1.0, self.line);
        v.selection.bg_fill = self.accent.gamma_multiply(0.30);
        v.selection.stroke = Stroke::new(1.0, self.accent);
        v.hyperlink_color = self.accent;
        let widgets = &mut v.widgets;
        widgets.noninteractive.bg_stroke = Stroke::new(1.0, self.line);
        for part in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active, &mut widgets.open] {
            (part.bg_fill, part.weak_bg_fill, part.bg_stroke) = (self.field, self.field, Stroke::NONE);
            part.corner_radius = CornerRadius::same(4);
            part.expansion = 0.0;
        }
        widgets.hovered.bg_stroke = Stroke::new(1.0, self.accent.gamma_multiply(0.6));
        widgets.active.bg_stroke = Stroke::new(1.0, self.accent);
        v
    }

    /// Returns the colour of a kept design.
    pub fn kept_colour(&self, slot: DesignSlot) -> Color32 {
        self.kept[match slot {
            DesignSlot::A => 0,
            DesignSlot::B => 1,
            DesignSlot::C => 2,
        }]
    }

    /// Returns the frame of a plot or a group: a card.
    pub fn card(&self) -> egui::Frame {
        egui::Frame::new()
            .fill(self.card)
            .stroke(Stroke::new(1.0, self.line))
            .corner_radius(CornerRadius::same(6))
            .inner_margin(Margin::same(space::MEDIUM as i8))
    }
}

fn sizes() -> std::collections::BTreeMap<TextStyle, FontId> {
    let font = |size| FontId::new(size, FontFamily::Proportional);
    [
        (TextStyle::Small, font(12.0)),
        (TextStyle::Body, font(13.0)),
        (TextStyle::Button, font(13.0)),
        (TextStyle::Heading, font(16.0)),
        (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
    ]
    .into()
}
