//! The nonlinear plant in time, with its sampled controller.
