//! The finite-element model of a structure that turns about a pivot.

use super::element::{Element, ElementShape, Integration, Theory, element_matrices};
use super::mesh::ElementMesh;
use super::profile::Profile;
use crate::Error;
use crate::parameters::{Beam, PointMass};
use crate::tolerance::AT_PIVOT;
use counterpoise_linalg::Mat;
use nalgebra::Matrix4;

/// M q'' + C q' + K q = p, q the deflections (upward, perpendicular to the axis) and rotations (nose-up) of the nodes.
///
/// The vectors of the two rigid motions say how weight, heave and platform pitch act on it: with every unknown relative
/// to a platform that heaves with a_p, p = -(g + a_p) M heave cos theta + (hub torque at `hub_rotation`), and the hub's
/// deflection is held. Whatever the elements were, M heave is the mass that each unknown carries.
#[derive(Debug, Clone, PartialEq)]
pub struct FeModel {
    /// Mass matrix, n x n, symmetric positive definite.
    pub M: Mat,
    /// Stiffness matrix, n x n, symmetric.
    pub K: Mat,
    /// Damping matrix, n x n, if one was given.
    pub C: Option<Mat>,
    /// q of the rigid upward translation by 1 m.
    pub heave: Vec<f64>,
    /// q of the rigid nose-up rotation by 1 rad about the pivot.
    pub pitch: Vec<f64>,
    /// The unknowns at the hub, if a node lies at the pivot.
    pub hub: Option<NodeRows>,
    /// The unknowns at the tip.
    pub tip: NodeRows,
    /// Distance of the tip from the pivot, m.
    pub tip_arm_m: f64,
    /// Part that was left out if the model was condensed to balanced shapes.
    pub truncation: Option<Truncation>,
}

/// Part of a structure that the balanced shapes leave out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truncation {
    /// Hankel values that were kept; two belong to a lightly damped mode.
    pub kept: usize,
    /// Twice the sum of the values left out, relative to the largest: an *estimate* of the largest error over all frequencies, because the
    /// values are computed from low-rank factors of the Gramians and the shapes are used on both sides.
    pub estimated_error: f64,
    /// Factorisations that it took.
    pub steps: usize,
}

/// Unknowns that belong to a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NodeRows {
    /// Index of its deflection.
    pub deflection: usize,
    /// Index of its rotation.
    pub rotation: usize,
}

/// Options of the finite-element model of a beam.
#[derive(Debug, Clone, PartialEq)]
pub struct FeOptions {
    /// Places of the nodes.
    pub mesh: ElementMesh,
    /// Shear and rotary inertia.
    pub theory: Theory,
    /// Source of the elements' cross sections.
    pub integration: Integration,
}

impl Default for FeOptions {
    /// 24 Bernoulli-Euler elements by quadrature with a node at the pivot: on a beam like the reference rig's the
    /// tenth mode is within 0.1 %.
    fn default() -> Self {
        Self {
            mesh: ElementMesh::Pivoted(24),
            theory: Theory::default(),
            integration: Integration::default(),
        }
    }
}

/// Mass that is fixed to the structure besides the beam's own.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AttachedMasses {
    /// Point masses; one beyond an end of the beam hangs on it by a rigid arm.
    pub masses: Vec<PointMass>,
    /// Moment of inertia without first moment, at the pivot, kg m^2.
    pub hub_inertia_kg_m2: f64,
}

impl FeModel {
    /// Returns the model of a beam with what is fitted to it; unknowns 2 i and 2 i + 1 are deflection and rotation of node i.
    ///
    /// # Errors
    /// [`Error::Parameter`] for a beam, mesh or mass out of range, [`Error::PowerLaw`] as for [`element_matrices`].
    pub fn beam(beam: &Beam, fitted: &AttachedMasses, options: &FeOptions) -> Result<Self, Error> {
        let profile = Profile::new(beam)?;
        let nodes = options.mesh.nodes_m(&profile, beam.pivot_m)?;
        let mut out = Self::rigid_body(&nodes, beam.pivot_m);
        let mut shapes = Vec::with_capacity(nodes.len() - 1);
        for (i, ends) in nodes.windows(2).enumerate() {
            let one = element_matrices(&profile, ends[0], ends[1], options.theory, options.integration)?;
            out.place(i, &one);
            shapes.push(one.shape);
        }
        fitted.masses.iter().try_for_each(|mass| out.fit(mass, &nodes, &shapes))?;
        let hub = PointMass {
            name: "hub".to_owned(),
            position_m: beam.pivot_m,
            mass_kg: 0.0,
            inertia_kg_m2: fitted.hub_inertia_kg_m2,
        };
        out.fit(&hub, &nodes, &shapes)?;
        Ok(out)
    }

    /// Returns the total mass, kg.
    pub fn mass_kg(&self) -> f64 {
        self.inner(&self.heave, &self.heave)
    }

    /// Returns the first moment of mass about the pivot, kg m.
    pub fn first_moment_kg_m(&self) -> f64 {
        self.inner(&self.heave, &self.pitch)
    }

    /// Returns the moment of inertia about the pivot, kg m^2.
    pub fn inertia_kg_m2(&self) -> f64 {
        self.inner(&self.pitch, &self.pitch)
    }

    /// Returns M heave: the mass and first moment that each unknown carries, kg and kg m. Weight and heave load the structure with
    /// -(g + a_p) cos theta of it.
    pub fn carried_moments(&self) -> Vec<f64> {
        (&self.M * &Mat::col(&self.heave)).as_slice().to_vec()
    }

    /// Returns a' M b.
    pub fn inner(&self, a: &[f64], b: &[f64]) -> f64 {
        let carried = &self.M * &Mat::col(b);
        a.iter().zip(carried.as_slice()).map(|(a, m)| a * m).sum()
    }

    fn rigid_body(nodes: &[f64], pivot_m: f64) -> Self {
        let n = 2 * nodes.len();
        let length = nodes[nodes.len() - 1] - nodes[0];
        let rows = |i: usize| NodeRows { deflection: 2 * i, rotation: 2 * i + 1 };
        let at_pivot = nodes.iter().position(|x| (x - pivot_m).abs() <= AT_PIVOT * length);
        Self {
            M: Mat::zeros(n, n),
            K: Mat::zeros(n, n),
            C: None,
            heave: (0..n).map(|i| if i % 2 == 0 { 1.0 } else { 0.0 }).collect(),
            pitch: (0..n).map(|i| if i % 2 == 0 { nodes[i / 2] - pivot_m } else { 1.0 }).collect(),
            hub: at_pivot.map(rows),
            tip: rows(nodes.len() - 1),
            tip_arm_m: nodes[nodes.len() - 1] - pivot_m,
            truncation: None,
        }
    }

    fn place(&mut self, index: usize, element: &Element) {
        add_block(&mut self.M, 2 * index, &element.mass);
        add_block(&mut self.K, 2 * index, &element.stiffness);
    }

    /// Adds a point mass through the interpolation of the element that carries it.
    fn fit(&mut self, mass: &PointMass, nodes: &[f64], shapes: &[ElementShape]) -> Result<(), Error> {
        for (field, value) in [("mass", mass.mass_kg), ("inertia", mass.inertia_kg_m2)] {
            if value.is_nan() || value < 0.0 || value.is_infinite() || !mass.position_m.is_finite() {
                let parameter = format!("beam.mass \"{}\".{field}", mass.name);
                return Err(Error::Parameter {
                    parameter,
                    value,
                    allowed: "must be finite and not negative".into(),
                });
            }
        }
        let last = nodes.len() - 1;
        let carrier = mass.position_m.clamp(nodes[0], nodes[last]);
        let index = nodes.partition_point(|&x| x <= carrier).clamp(1, last) - 1;
        let local = shapes[index].at(carrier);
        let arm = mass.position_m - carrier;
        let moved = local.deflection + local.rotation * arm;
        let turned = local.rotation;
        let added =
            moved * moved.transpose() * mass.mass_kg + turned * turned.transpose() * mass.inertia_kg_m2;
        add_block(&mut self.M, 2 * index, &added);
        Ok(())
    }
}

/// Adds a block on the diagonal of a matrix.
fn add_block(matrix: &mut Mat, first: usize, block: &Matrix4<f64>) {
    for i in 0..4 {
        for j in 0..4 {
            matrix[(first + i, first + j)] += block[(i, j)];
        }
    }
}
