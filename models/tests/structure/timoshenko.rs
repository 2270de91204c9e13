use super::{assert_close, frequencies, uniform_beam, unit_beam};
use counterpoise_linalg::sym_gen_eigen;
use counterpoise_models::SectionShape;
use counterpoise_models::structure::{
    AttachedMasses, ElementMesh, FeModel, FeOptions, Integration, Support, Theory,
};

fn options(elements: usize, theory: Theory) -> FeOptions {
    FeOptions { mesh: ElementMesh::Equal(elements), theory, integration: Integration::Quadrature }
}

/// Lowest frequency of Timoshenko's beam on two hinges, half wave number `n`, unit E and rho:
/// (1/G') w^4 rho I - w^2 (A + I k^2 (1 + 1/G')) + I k^4 = 0 with G' = kappa G.
fn hinged_beam_frequency(area: f64, second: f64, rigidity: f64, n: f64) -> f64 {
    let k = n * std::f64::consts::PI;
    let (a, b, c) = (second / rigidity, area + second * k * k * (1.0 + 1.0 / rigidity), second * k.powi(4));
    ((b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)).sqrt()
}

#[test]
fn a_thick_hinged_beam_has_the_closed_form() {
    let (area, second) = (1.0, 0.01);
    let beam = unit_beam(SectionShape::Given { area_m2: [area; 2], second_moment_m4: [second; 2] });
    let frequencies = |n: usize| {
        let model =
            FeModel::beam(&beam, &AttachedMasses::default(), &options(n, Theory::Timoshenko)).unwrap();
        let free: Vec<usize> = (0..2 * n + 2).filter(|&i| i != 0 && i != 2 * n).collect();
        let (values, _) =
            sym_gen_eigen(&model.K.select(&free, &free), &model.M.select(&free, &free)).unwrap();
        values
    };
    let rigidity = 5.0 / 6.0 / (2.0 * 1.3);
    for n in 1..=3 {
        let expected = hinged_beam_frequency(area, second, rigidity, n as f64);
        let errors = [20, 40, 80].map(|elements| frequencies(elements)[n - 1].sqrt() / expected - 1.0);
        assert!((0.0..1e-3).contains(&errors[2]), "{n}: {errors:?}");
        assert!(errors.windows(2).all(|e| (e[0] / e[1]).log2() > 1.9), "{n}: {errors:?}");
    }
}

#[test]
fn a_slender_beam_is_bernoulli_eulers() {
    let beam = unit_beam(SectionShape::Given { area_m2: [1.0; 2], second_moment_m4: [1e-8; 2] });
    let of = |theory| frequencies(&beam, &AttachedMasses::default(), &options(10, theory), Support::Free)[0];
    assert_close(of(Theory::Timoshenko) / of(Theory::BernoulliEuler), 1.0, 1e-5);
}

#[test]
fn shear_and_rotary_inertia_lower_every_frequency() {
    let of = |theory| {
        frequencies(&uniform_beam(), &AttachedMasses::default(), &options(10, theory), Support::Pinned)
    };
    let (with, without) = (of(Theory::Timoshenko), of(Theory::BernoulliEuler));
    assert!(with.iter().zip(&without).take(5).all(|(a, b)| a < b));
}
