//! A feedforward from a noisy sensor: the optimal filter in front, and what is not known after it.

use counterpoise_linalg::{Mat, care, sylvester};
use counterpoise_lti::{StateSpace, Timebase};

use super::{Problem, Regulator};
use crate::Error;
use crate::cause::DesignEquation;
use crate::certificate::{Equation, mean_square, riccati};
use crate::finding::Part;

/// The filter of the disturbance on \[x_d; x_s\], and what its innovation tells of the plant.
pub(super) struct Filter {
    system: StateSpace,
    L: Mat,
    Lx: Mat,
    error_cost: Option<f64>,
    pub equation: Equation,
    density: f64,
}

impl Problem {
    /// The Kalman filter of \[x_d; x_s\], extended by Sylvester to the plant that the disturbance drives.
    pub(super) fn filter(&self, density: f64, part: Part) -> Result<Filter, Error> {
        let system = self.sensor_system()?;
        let W = &system.B * &system.B.t();
        let V = Mat::eye(1).scale(density);
        let solved = care(&system.A.t(), &system.C.t(), &W, &V, None)?;
        let solution = riccati(DesignEquation::DisturbanceFilter, part, solved)?;
        let L = solution.F.t();
        let (open, entering) = self.uncontrolled_plant();
        let shared = solution.X.block(0, 0, self.generator.order(), system.order());
        let settled = (&system.A - &(&L * &system.C)).t();
        let S = sylvester(&open, &settled, &-(&entering * &shared))?;
        let gain = &S * &system.C.t().scale(1.0 / density);
        let error_cost = self.error_cost(&system, &L, &gain, density)?;
        let (_, _, u) = self.core.sizes();
        let Lx = gain.vstack(&Mat::zeros(u, 1));
        Ok(Filter { system, L, Lx, error_cost, equation: solution.into(), density })
    }

    /// Generator and sensor: from w to the measured disturbance, states \[x_d; x_s\].
    fn sensor_system(&self) -> Result<StateSpace, Error> {
        let first = self.generator.select(&[0], &[0]);
        match &self.sensor {
            Some(sensor) => Ok(counterpoise_lti::series(&first, sensor)?),
            None => Ok(first),
        }
    }

    /// Returns what the estimation error of the plant's state costs: it is driven by w and by the noise, through the filter.
    /// `None` if it is not bounded.
    fn error_cost(&self, system: &StateSpace, L: &Mat, Lx: &Mat, density: f64) -> Result<Option<f64>, Error> {
        let (open, entering) = self.uncontrolled_plant();
        let (k, f, d) = (open.nrows(), system.order(), self.generator.order());
        let into = &entering.hstack(&Mat::zeros(k, f - d)) - &(Lx * &system.C);
        let settled = &system.A - &(L * &system.C);
        let A = Mat::from_blocks(&[&[&open, &into], &[&Mat::zeros(f, k), &settled]]);
        let noise = -density.sqrt();
        let B = Mat::from_blocks(&[&[&Mat::zeros(k, 1), &Lx.scale(noise)], &[&system.B, &L.scale(noise)]]);
        let C = self.core.output().block(0, 0, 1, k).hstack(&Mat::zeros(1, f));
        mean_square(&StateSpace::new(A, B, C, Mat::zeros(1, 2), Timebase::Continuous)?)
    }

    /// x' = A x + B v + E C_d x_d + L_x nu, x_f' = A_f x_f + L_f nu, nu = measured - C_f x_f, v = -F x - F_d x_d.
    pub(super) fn measured_module(
        &self,
        regulator: &Regulator,
        filter: &Filter,
    ) -> Result<StateSpace, Error> {
        let (k, f, d) = (self.core.order(), filter.system.order(), self.generator.order());
        let input = self.core.input();
        let v = (-&regulator.riccati.F).hstack(&-&regulator.Fd).hstack(&Mat::zeros(1, f - d));
        let from_filter = &self.ECd.hstack(&Mat::zeros(k, f - d)) - &(&filter.Lx * &filter.system.C);
        let settled = &filter.system.A - &(&filter.L * &filter.system.C);
        let open = Mat::from_blocks(&[&[&self.core.state(), &from_filter], &[&Mat::zeros(f, k), &settled]]);
        let A = &open + &(&input.vstack(&Mat::zeros(f, 1)) * &v);
        let B = filter.Lx.vstack(&filter.L);
        let C = self.core.control_row(&v).vstack(&self.expected_rate_row(f)).vstack(&v);
        Ok(StateSpace::new(A, B, C, Mat::zeros(3, 1), Timebase::Continuous)?)
    }

    /// Returns what the solutions predict: the full-information loop on \[x; x_d\] driven by the innovation, plus what the
    /// estimation error costs. Equal to tr(L' X_j L V) + ..., without that formula's cancellation.
    pub(super) fn measured_cost(&self, regulator: &Regulator, filter: &Filter) -> Result<Option<f64>, Error> {
        let innovation = filter.Lx.vstack(&filter.L.block(0, 0, self.generator.order(), 1));
        let known = mean_square(&self.informed_loop(regulator, &innovation.scale(filter.density.sqrt()))?)?;
        Ok(known.zip(filter.error_cost).map(|(known, unknown)| known + unknown))
    }

    /// [x; x_d] under v = -F x - F_d x_d, from `noise` to (z1, v).
    fn informed_loop(&self, regulator: &Regulator, noise: &Mat) -> Result<StateSpace, Error> {
        let (k, d) = (self.core.order(), self.generator.order());
        let v = (-&regulator.riccati.F).hstack(&-&regulator.Fd);
        let open =
            Mat::from_blocks(&[&[&self.core.state(), &self.ECd], &[&Mat::zeros(d, k), &self.generator.A]]);
        let A = &open + &(&self.core.input().vstack(&Mat::zeros(d, 1)) * &v);
        let C = self.core.output().hstack(&Mat::zeros(1, d)).vstack(&v);
        let D = Mat::zeros(2, noise.ncols());
        Ok(StateSpace::new(A, noise.clone(), C, D, Timebase::Continuous)?)
    }

    pub(super) fn measured_loop(&self, module: &StateSpace, filter: &Filter) -> Result<StateSpace, Error> {
        let (n, e, _) = self.core.sizes();
        let (source, k) = (&filter.system, module.order());
        let driven = source.B.vstack(&Mat::zeros(n + e + k, 1));
        let sensed = Mat::zeros(source.order() + n + e, 1).vstack(&module.B.scale(filter.density.sqrt()));
        self.assembled_loop(module, source, &(&module.B * &source.C), &driven.hstack(&sensed))
    }
}
