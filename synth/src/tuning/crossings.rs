//! Gain, phase and delay margin as rows: the crossings of the loop between two frequencies of the grid, and how they move.

use std::f64::consts::PI;

use counterpoise_linalg::C64;

use super::LoopLimits;
use super::loop_response::{Row, TuningResponse};

/// A row for each crossing of the negative real axis and of the unit circle that a margin speaks of.
pub(crate) fn crossings(response: &TuningResponse<'_>, limits: &LoopLimits) -> Vec<Row> {
    let mut rows = Vec::new();
    for k in 1..response.L.len() {
        if limits.gain_margin_db > 0.0 {
            rows.extend(gain_row(response, k, limits.gain_margin_db));
        }
        if limits.phase_margin_deg > 0.0 || limits.delay_margin_s > 0.0 {
            rows.extend(phase_rows(response, k, limits));
        }
    }
    rows
}

/// dL in a parameter.
fn loop_derivative(response: &TuningResponse<'_>, k: usize, parameter: usize) -> C64 {
    response.L[k] * response.slopes[k][parameter]
}

/// Returns where L crosses the negative real axis between k - 1 and k: what the gain margin there lacks, relatively.
fn gain_row(response: &TuningResponse<'_>, k: usize, limit_db: f64) -> Option<Row> {
    let (a, b) = (response.L[k - 1], response.L[k]);
    if (a.im < 0.0) == (b.im < 0.0) {
        return None;
    }
    let part = a.im / (a.im - b.im);
    let x = a.re + part * (b.re - a.re);
    if x >= 0.0 {
        return None;
    }
    let db_per_unit = 20.0 / std::f64::consts::LN_10;
    let db = db_per_unit * -(-x).ln();
    let slope_of = |parameter: usize| {
        let (da, db_) =
            (loop_derivative(response, k - 1, parameter), loop_derivative(response, k, parameter));
        let of_part = (da.im * (a.im - b.im) - a.im * (da.im - db_.im)) / (a.im - b.im).powi(2);
        let dx = da.re + part * (db_.re - da.re) + of_part * (b.re - a.re);
        // The margin is |db|.
        let d_db = -db_per_unit * dx / x;
        -d_db * db.signum() / limit_db
    };
    let slope = (0..response.slopes[k].len()).map(slope_of).collect();
    Some(Row { value: 1.0 - db.abs() / limit_db, slope })
}

/// Returns where |L| crosses 1 between k - 1 and k: what phase and delay margin lack there, relatively.
fn phase_rows(response: &TuningResponse<'_>, k: usize, limits: &LoopLimits) -> Vec<Row> {
    let (a, b) = (response.L[k - 1], response.L[k]);
    let (la, lb) = (a.norm().ln(), b.norm().ln());
    if (la < 0.0) == (lb < 0.0) {
        return Vec::new();
    }
    let part = la / (la - lb);
    let turn = (b / a).arg();
    // The angle above -180 degrees, from 0 to 360.
    let angle = (a.arg() + part * turn + PI).rem_euclid(2.0 * PI);
    let (wa, wb) = (response.rates[k - 1].ln(), response.rates[k].ln());
    let rate = (wa + part * (wb - wa)).exp();
    let slopes_of = |parameter: usize| {
        let (da, db) = (response.slopes[k - 1][parameter], response.slopes[k][parameter]);
        let of_part = (da.re * (la - lb) - la * (da.re - db.re)) / (la - lb).powi(2);
        let of_angle = da.im + part * (db.im - da.im) + of_part * turn;
        (of_angle, of_part * (wb - wa))
    };
    let moves: Vec<(f64, f64)> = (0..response.slopes[k].len()).map(slopes_of).collect();
    let mut rows = Vec::new();
    if limits.phase_margin_deg > 0.0 {
        let limit = limits.phase_margin_deg.to_radians();
        let (margin, sign) = if angle <= PI { (angle, 1.0) } else { (2.0 * PI - angle, -1.0) };
        let slope = moves.iter().map(|(of_angle, _)| -sign * of_angle / limit).collect();
        rows.push(Row { value: 1.0 - margin / limit, slope });
    }
    if limits.delay_margin_s > 0.0 {
        let delay = angle / rate;
        let slope = moves
            .iter()
            .map(|(of_angle, of_rate)| -(of_angle / rate - delay * of_rate) / limits.delay_margin_s);
        rows.push(Row { value: 1.0 - delay / limits.delay_margin_s, slope: slope.collect() });
    }
    rows
}
