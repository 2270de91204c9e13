//! Plots: data first, then drawn in the window, and written as numbers, drawing or pixels.
//!
//! Modules in reading order: [`min_max_pyramid`], [`line_simplification`], [`curve_points`], [`chart`], [`csv`], [`chart_figure`],
//! [`axis_ticks`], [`plot_limits`], [`hidden_curves`], [`second_cursor`], [`bound_regions`], [`plot_labels`], [`cross_plot`], [`chart_heading`], [`chart_view`].

pub mod axis_ticks;
pub mod bound_regions;
pub mod chart;
pub mod chart_figure;
pub mod chart_heading;
pub mod chart_view;
pub mod cross_plot;
pub mod csv;
pub mod curve_points;
pub mod hidden_curves;
pub mod line_simplification;
pub mod min_max_pyramid;
pub mod plot_labels;
pub mod plot_limits;
pub mod second_cursor;
