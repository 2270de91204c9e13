//! The simulator as the diagnosis asks it: every recording replayed in closed loop for any mechanism.

use counterpoise_controller::ProportionalIntegral;
use counterpoise_models::Parameters;
use counterpoise_simulate::history::ReadingColumns;
use counterpoise_simulate::recording::{Channel, Recording};
use counterpoise_simulate::replay::{Loop, Replay, Replayer};

use crate::bench::{Bench, Misfit, rms};
use crate::error::Error;
use crate::locate::Measured;

/// Channels whose misfit is scored; the platform's are what drives the replay.
const SCORED: [Channel; 4] = [Channel::Control, Channel::HubRate, Channel::MotorRate, Channel::HubPosition];

/// Recordings of one machine, ready to be replayed.
pub struct Replays<'a> {
    base: &'a Parameters,
    control: Loop,
    recordings: &'a [Recording],
    ready: Vec<Replayer<'a>>,
    noisy: Vec<Recording>,
    noise: Vec<[f64; SCORED.len()]>,
}

impl<'a> Replays<'a> {
    /// Prepares the recordings: the platform's motion is reconstructed once, the noise of each channel is looked at.
    ///
    /// # Errors
    /// A recording that cannot be replayed.
    pub fn new(
        base: &'a Parameters,
        controller: &ProportionalIntegral,
        recordings: &'a [Recording],
    ) -> Result<Self, Error> {
        let ready = recordings.iter().map(|r| Replayer::new(base, r)).collect::<Result<Vec<_>, _>>()?;
        let noisy = recordings.iter().map(|r| with_noisy_demand(r, base)).collect();
        let noise = recordings.iter().map(|r| SCORED.map(|c| r.column(c).map_or(0.0, white_noise))).collect();
        Ok(Self { base, control: Loop::Closed(controller.clone()), recordings, ready, noisy, noise })
    }

    /// The replay of one recording.
    ///
    /// # Errors
    /// A mechanism that cannot be simulated.
    pub fn replay(&self, parameters: &Parameters, index: usize) -> Result<Replay, Error> {
        if self.same_platform_sensors(parameters) {
            return Ok(self.ready[index].replay(parameters, &self.control)?);
        }
        Ok(Replayer::new(parameters, &self.recordings[index])?.replay(parameters, &self.control)?)
    }

    /// The recordings as the balances take them; those without hub rate or control are left out.
    pub fn measured(&self) -> Vec<Measured> {
        self.recordings.iter().filter_map(measured).collect()
    }

    fn same_platform_sensors(&self, parameters: &Parameters) -> bool {
        let (ours, theirs) = (&self.base.sensors, &parameters.sensors);
        ours.platform_gyro == theirs.platform_gyro
            && ours.platform_accelerometer == theirs.platform_accelerometer
            && ours.accelerometer_lever_arm_m == theirs.accelerometer_lever_arm_m
    }
}

/// One recording as the balances take it.
pub fn measured(recording: &Recording) -> Option<Measured> {
    let still = || vec![0.0; recording.len()];
    Some(Measured {
        period_s: recording.sample_period_s,
        control: recording.control_v.clone()?,
        hub_rate: recording.hub_rate_rad_s.clone()?,
        platform_rate: recording.platform_rate_rad_s.clone().unwrap_or_else(still),
        platform_accel: recording.platform_accel_m_s2.clone().unwrap_or_else(still),
        motor_rate: recording.motor_rate_rad_s.clone(),
        hub_position: recording.hub_position_rad.clone(),
    })
}

impl Bench for Replays<'_> {
    fn count(&self) -> usize {
        self.recordings.len()
    }

    fn misfit(&self, parameters: &Parameters, index: usize) -> Option<Vec<Misfit>> {
        let replay = self.replay(parameters, index).ok()?;
        let recording = &self.recordings[index];
        let mut out = Vec::new();
        for (c, channel) in SCORED.into_iter().enumerate() {
            let Some(fit) = replay.channels.iter().find(|f| f.channel == channel) else { continue };
            let recorded = recording.column(channel)?;
            let floor = fit.floor.max(self.noise[index][c]);
            let simulated = channel.of(&replay.simulated);
            let difference = |(s, r): (&f64, &f64)| if r.is_finite() { (s - r) / floor } else { 0.0 };
            let residual: Vec<f64> = simulated.iter().zip(recorded).map(difference).collect();
            out.push(Misfit { channel: channel.name(), residual, floor, spread: deviation(recorded) });
        }
        Some(out)
    }

    /// The demand with noise like the gyroscope's is the loop with another noise of the gyroscope.
    fn wander(&self, parameters: &Parameters, index: usize) -> Vec<f64> {
        let Ok(quiet) = self.replay(parameters, index) else { return Vec::new() };
        let shaken = Replayer::new(parameters, &self.noisy[index]).and_then(|r| r.replay(parameters, &self.control));
        let Ok(shaken) = shaken else { return Vec::new() };
        let fitted = SCORED.into_iter().filter_map(|c| quiet.channels.iter().find(|f| f.channel == c));
        fitted
            .map(|fit| {
                let apart = apart(fit.channel, &quiet.simulated, &shaken.simulated) / fit.floor;
                let own = if fit.channel == Channel::Control { 1.0 } else { 0.0 };
                (apart * apart - own).max(0.0).sqrt()
            })
            .collect()
    }
}

fn apart(channel: Channel, a: &ReadingColumns, b: &ReadingColumns) -> f64 {
    let difference: Vec<f64> = channel.of(a).iter().zip(channel.of(b)).map(|(x, y)| x - y).collect();
    rms(&difference)
}

fn deviation(series: &[f64]) -> f64 {
    let finite: Vec<f64> = series.iter().copied().filter(|v| v.is_finite()).collect();
    let mean = finite.iter().sum::<f64>() / finite.len().max(1) as f64;
    rms(&finite.iter().map(|v| v - mean).collect::<Vec<f64>>())
}

/// White noise of a channel from its third differences, by their median: steps and slow motion do not disturb it.
fn white_noise(series: &[f64]) -> f64 {
    let third = series.windows(4).map(|w| (w[3] - 3.0 * (w[2] - w[1]) - w[0]).abs());
    let mut sizes: Vec<f64> = third.filter(|d| d.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    median / (0.6745 * 20f64.sqrt())
}

/// The recording with noise on its demand of the size of the hub gyroscope's (a fixed sequence).
fn with_noisy_demand(recording: &Recording, p: &Parameters) -> Recording {
    let size = p.sensors.hub_gyro.noise_rms.max(1e-9);
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut uniform = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
    let mut noisy = recording.clone();
    if let Some(demand) = noisy.demand_rad_s.as_mut() {
        demand.iter_mut().for_each(|r| *r += size * normal());
    }
    noisy
}
