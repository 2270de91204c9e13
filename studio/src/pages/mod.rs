//! The pages of the window.
//!
//! Each page is one function `show(studio, ui, queue)`: it draws what the studio knows and pushes commands; it changes nothing of the
//! project itself. How a page is written:
//!
//! 1. Take the design by [`ComputedResults::design_at`](crate::results::ComputedResults::design_at), a verification by
//!    [`ComputedResults::verification`](crate::results::ComputedResults::verification); show a stale one dimmed.
//! 2. Draw plots as [`Chart`](crate::charts::chart::Chart)s through [`widgets::show_chart`], which makes them copyable, in cells of
//!    [`widgets::grid_cells`].
//! 3. Show numbers of the project by [`widgets::number_field`]: unit, range and meaning come from the project file's reference.
//! 4. Say in place what is missing and how to get it ([`widgets::show_placeholder`]), never with a blank.
//!
//! Modules in reading order: [`widgets`], [`frequency_charts`], [`no_controller`], [`welcome`], [`recent_places`], [`file_browser`], [`plant`],
//! [`number_groups`], [`beam_drawing`], [`schematic`], [`reduce`], [`plot_tiles`], [`design`], [`plot_handles`], [`edge_grips`], [`weight_plot`], [`design_charts`],
//! [`loop_charts`], [`requirement_values`], [`requirement_bounds`], [`requirement_strip`], [`design_figures`], [`kept_designs`], [`design_history`], [`verify`],
//! [`verify_charts`], [`mechanism_chart`], [`measurements`], [`diagnose`], [`recording_mapping`], [`recording_charts`], [`recording_cross_plot`], [`findings`], [`commission`],
//! [`round_charts`], [`studies`], [`report_view`], [`project_text`], [`text_colours`].

pub mod beam_drawing;
pub mod commission;
pub mod design;
pub mod design_charts;
pub mod design_figures;
pub mod design_history;
pub mod diagnose;
pub mod edge_grips;
pub mod file_browser;
pub mod findings;
pub mod frequency_charts;
pub mod kept_designs;
pub mod loop_charts;
pub mod measurements;
pub mod mechanism_chart;
pub mod no_controller;
pub mod number_groups;
pub mod plant;
pub mod plot_handles;
pub mod plot_tiles;
pub mod project_text;
pub mod recent_places;
pub mod recording_charts;
pub mod recording_cross_plot;
pub mod recording_mapping;
pub mod reduce;
pub mod report_view;
pub mod requirement_bounds;
pub mod requirement_strip;
pub mod requirement_values;
pub mod round_charts;
pub mod schematic;
pub mod studies;
pub mod text_colours;
pub mod verify;
pub mod verify_charts;
pub mod weight_plot;
pub mod welcome;
pub mod widgets;
