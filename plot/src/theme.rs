//! Every colour and line of figures and reports, in one place.

use crate::{Colour, Dash};

/// Custom properties for the light theme, for the dark one, and the classes that figures use. The numbered colours are those of
/// Okabe and Ito (told apart with any colour vision), lightened on dark ground.
pub const FIGURE_CSS: &str = "\
:root{--ground:#fff;--panel:#fff;--ink:#1b2733;--soft:#5b6b7a;--grid:#e3e8ee;--frame:#9aa8b5;\
--c1:#0072b2;--c2:#d55e00;--c3:#009e73;--c4:#b0609a;--c5:#c98a00;--c6:#56b4e9;--c7:#8794a1;\
--good:#00754f;--bad:#b8430a;--none:#6b7a89}
@media (prefers-color-scheme:dark){:root{--ground:#12181f;--panel:#182029;--ink:#e4eaf0;--soft:#9fb0bf;--grid:#2a3540;\
--frame:#5a6b7a;--c1:#5ab8f0;--c2:#ff9350;--c3:#3fd0a0;--c4:#e3a1cd;--c5:#efc04f;--c6:#a8dcff;--c7:#8c9cab;\
--good:#49d3a2;--bad:#ff9a62;--none:#93a3b2}}
.fig{font-family:system-ui,'Segoe UI','DejaVu Sans',sans-serif;font-size:12px;fill:var(--ink)}
.fig .axis{fill:var(--soft)}
.fig .grid{stroke:var(--grid);stroke-width:1;fill:none}
.fig .minor{stroke:var(--grid);stroke-width:.5;fill:none;opacity:.8}
.fig .frame{stroke:var(--frame);stroke-width:1;fill:none}
.fig .line{fill:none;stroke-width:1.7;stroke-linejoin:round}
.fig .ring{fill:var(--panel);stroke-width:2}
.fig .guide{stroke:var(--soft);stroke-width:1.1;stroke-dasharray:2 3;fill:none}
.fig .band{opacity:.22;stroke:none}
.fig .heat{fill:var(--c1);stroke:var(--grid);stroke-width:1}
.fig .blind{fill:var(--grid);stroke:none}
.fig .on{fill:var(--panel)}
.fig .named{stroke:var(--c2);stroke-width:2.5;fill:none}
.fig .dashed{stroke-dasharray:7 4}
.fig .dotted{stroke-dasharray:1.6 3.4;stroke-linecap:round}
.s1{stroke:var(--c1)}.s2{stroke:var(--c2)}.s3{stroke:var(--c3)}.s4{stroke:var(--c4)}.s5{stroke:var(--c5)}.s6{stroke:var(--c6)}.s7{stroke:var(--c7)}
.f1{fill:var(--c1)}.f2{fill:var(--c2)}.f3{fill:var(--c3)}.f4{fill:var(--c4)}.f5{fill:var(--c5)}.f6{fill:var(--c6)}.f7{fill:var(--c7)}
";

/// The class that strokes in a colour.
pub fn stroke_class(colour: Colour) -> &'static str {
    match colour {
        Colour::First => "s1",
        Colour::Second => "s2",
        Colour::Third => "s3",
        Colour::Fourth => "s4",
        Colour::Fifth => "s5",
        Colour::Sixth => "s6",
        Colour::Muted => "s7",
    }
}

/// The class that fills in a colour.
pub fn fill_class(colour: Colour) -> &'static str {
    match colour {
        Colour::First => "f1",
        Colour::Second => "f2",
        Colour::Third => "f3",
        Colour::Fourth => "f4",
        Colour::Fifth => "f5",
        Colour::Sixth => "f6",
        Colour::Muted => "f7",
    }
}

/// The class that dashes; empty for an unbroken line.
pub fn dash_class(dash: Dash) -> &'static str {
    match dash {
        Dash::Solid => "",
        Dash::Dashed => " dashed",
        Dash::Dotted => " dotted",
    }
}
