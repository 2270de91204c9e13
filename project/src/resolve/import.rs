//! The `[plant.import]` section: the structure as mass, stiffness and damping matrices of a finite-element package.

use std::sync::{Mutex, MutexGuard, PoisonError};

use counterpoise_linalg::{Sparse, sparse::ProgressObserver};
use counterpoise_models::PointMass;
use counterpoise_models::structure::fe::AttachedMasses;
use counterpoise_models::structure::import::{
    Dmig, Imported, NodeMap, has_labels, is_binary_op4, matrix_market, read_binary_op4, read_dmig,
    read_labels, read_op4, read_rows, read_triplets,
};
use counterpoise_models::structure::{Condensation, FeModel, Shapes};

use super::structure::{assumed_ratio, masses};
use crate::file::field::{Field, NumberRange};
use crate::file::visit::{Count, NamedChoice, Visit, choose};

/// The structure as matrices from elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportedStructure {
    /// Format of the files.
    pub format: MatrixFormat,
    /// File of the mass matrix.
    pub mass: MatrixFile,
    /// File of the stiffness matrix.
    pub stiffness: MatrixFile,
    /// File of the damping matrix; an empty name if there is none.
    pub damping: MatrixFile,
    /// File that names the unknown of each row; empty unless the format is CalculiX'.
    pub row_names: String,
    /// File that says which node each row belongs to and where the nodes lie.
    pub node_map: String,
    /// Damping ratio of flexible mode 1, 2, ..., the last holding for all above, if there is no damping matrix.
    pub modal_damping: Vec<f64>,
    /// Shapes to which a structure is condensed.
    pub shapes: Shapes,
    /// Masses that a configuration can fit.
    pub masses: Vec<PointMass>,
    /// Content of the files.
    pub content: Option<ImportedContent>,
}

/// A matrix in a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct MatrixFile {
    /// Name of the file.
    pub file: String,
    /// Name of the matrix in it; empty for the only one.
    pub name: String,
}

/// The matrices and the node map, read.
#[derive(Debug, Clone, PartialEq)]
pub struct ImportedContent {
    /// The matrices.
    pub matrices: Imported,
    /// The node map.
    pub map: NodeMap,
}

/// File format of matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MatrixFormat {
    /// Matrix Market, one matrix a file.
    MatrixMarket,
    /// Nastran DMIG entries.
    Dmig,
    /// Nastran OUTPUT4, as text or binary.
    Op4,
    /// Abaqus' .mtx files, of FORMAT=MATRIX INPUT or COORDINATE.
    Abaqus,
    /// CalculiX' .sti and .mas files, and its .dof file that names their rows.
    Calculix,
}

impl NamedChoice for MatrixFormat {
    const NAMES: &'static [(&'static str, Self)] = &[
        ("matrix-market", Self::MatrixMarket),
        ("dmig", Self::Dmig),
        ("op4", Self::Op4),
        ("abaqus", Self::Abaqus),
        ("calculix", Self::Calculix),
    ];
}

impl NamedChoice for Shapes {
    const NAMES: &'static [(&'static str, Self)] = &[("modes", Self::Modes), ("balanced", Self::Balanced)];
}

impl ImportedContent {
    /// Returns the structure with what is fitted to it, condensed as `wanted` says if it is large or shapes are to be balanced. A structure that was
    /// condensed a moment ago is not condensed again.
    ///
    /// # Errors
    /// As for [`Imported::with_fitted_masses`] and [`Imported::condense`].
    pub fn structure(
        &self,
        fitted: &AttachedMasses,
        wanted: &Condensation,
        watch: &mut ProgressObserver,
    ) -> Result<FeModel, counterpoise_models::Error> {
        if !self.matrices.is_large() && wanted.shapes == Shapes::Modes {
            return self.compute_model(fitted, wanted, watch);
        }
        let is_same = |kept: &&CondensedStructure| {
            kept.wanted == *wanted && kept.fitted == *fitted && kept.content == *self
        };
        if let Some(kept) = condensed_structures().iter().find(is_same) {
            return Ok(kept.structure.clone());
        }
        let structure = self.compute_model(fitted, wanted, watch)?;
        let made = CondensedStructure {
            content: self.clone(),
            fitted: fitted.clone(),
            wanted: *wanted,
            structure: structure.clone(),
        };
        let mut all = condensed_structures();
        all.insert(0, made);
        all.truncate(KEPT_STRUCTURES);
        Ok(structure)
    }

    fn compute_model(
        &self,
        fitted: &AttachedMasses,
        wanted: &Condensation,
        watch: &mut ProgressObserver,
    ) -> Result<FeModel, counterpoise_models::Error> {
        if *fitted == AttachedMasses::default() {
            return self.matrices.condense(&self.map, wanted, watch);
        }
        self.matrices.with_fitted_masses(&self.map, fitted)?.condense(&self.map, wanted, watch)
    }
}

/// A condensed structure and what it was made from.
struct CondensedStructure {
    content: ImportedContent,
    fitted: AttachedMasses,
    wanted: Condensation,
    structure: FeModel,
}

/// Condensed structures that are kept: a design with two configurations asks for two in turn.
const KEPT_STRUCTURES: usize = 2;

/// Returns the structures that were condensed last, the newest first. A large one takes seconds, and every edit in the window and every
/// variation of a study asks for the same one again. The answer depends on nothing but what is compared.
fn condensed_structures() -> MutexGuard<'static, Vec<CondensedStructure>> {
    static CONDENSED: Mutex<Vec<CondensedStructure>> = Mutex::new(Vec::new());
    CONDENSED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns an import still to be read.
pub(crate) fn blank_structure() -> ImportedStructure {
    ImportedStructure {
        format: MatrixFormat::MatrixMarket,
        mass: MatrixFile::default(),
        stiffness: MatrixFile::default(),
        damping: MatrixFile::default(),
        row_names: String::new(),
        node_map: String::new(),
        modal_damping: Vec::new(),
        shapes: Shapes::default(),
        masses: Vec::new(),
        content: None,
    }
}

/// Reads or lists the import.
pub(crate) fn import(v: &mut dyn Visit, import: &mut ImportedStructure) {
    choose(
        v,
        &Field::new("format", "format of the matrix files").or_text("matrix-market"),
        &mut import.format,
    );
    v.text(&Field::new("mass_matrix", "file of the mass matrix, SI units"), &mut import.mass.file);
    v.text(
        &Field::new("stiffness_matrix", "file of the stiffness matrix, SI units"),
        &mut import.stiffness.file,
    );
    let damping = Field::new("damping_matrix", "file of the damping matrix, SI units");
    v.text(&damping.or_text(""), &mut import.damping.file);
    if matches!(import.format, MatrixFormat::Dmig | MatrixFormat::Op4) {
        let name = |key, meaning| Field::new(key, meaning).or_text("");
        v.text(&name("mass_name", "name of the mass matrix in its file"), &mut import.mass.name);
        v.text(&name("stiffness_name", "name of the stiffness matrix"), &mut import.stiffness.name);
        v.text(&name("damping_name", "name of the damping matrix"), &mut import.damping.name);
    }
    if import.format == MatrixFormat::Calculix {
        v.text(
            &Field::new("row_names", "file that names the node and component of each row (.dof)"),
            &mut import.row_names,
        );
    }
    let map = "file that states the node of each row and the positions of the nodes";
    v.text(&Field::new("node_map", map), &mut import.node_map);
    let ratios = Field::new(
        "modal_damping",
        "damping ratios of flexible mode 1, 2, ... if there is no damping matrix; 0.01 for every mode if neither is there",
    );
    let ratios = ratios.limit(NumberRange::Between(0.0, 1.0)).or_empty();
    v.numbers(&ratios, Count::AtLeastOne, &mut import.modal_damping);
    if import.damping.file.is_empty() {
        assumed_ratio(v, &ratios, &mut import.modal_damping);
    }
    let shapes = "shapes that a structure is condensed to: its lowest modes, or those that balanced truncation ranks first";
    choose(v, &Field::new("shapes", shapes).or_text("modes"), &mut import.shapes);
    masses(v, &mut import.masses);
    if let Some(content) = content(v, import) {
        import.content = Some(content);
    }
}

/// Returns what the files hold, where they are at hand and make a structure; what is wrong with them is said.
fn content(v: &mut dyn Visit, import: &ImportedStructure) -> Option<ImportedContent> {
    let map = read(v, "node_map", &import.node_map, NodeMap::parse)?;
    let matrices = match import.format {
        MatrixFormat::MatrixMarket => {
            visit_matrices(v, import, &map, |v, key, from| read(v, key, &from.file, matrix_market))
        }
        MatrixFormat::Op4 => visit_matrices(v, import, &map, |v, key, from| {
            read_bytes(v, key, &from.file, |bytes| op4_matrix(bytes, &from.name))
        }),
        MatrixFormat::Calculix => {
            let map = name_rows(v, import, &map)?;
            triplets(v, import, &map)
        }
        MatrixFormat::Abaqus if is_labelled(v, import)? => grids(v, import, |text, _| read_labels(text)),
        MatrixFormat::Abaqus => triplets(v, import, &map),
        MatrixFormat::Dmig => grids(v, import, dmig_matrix),
    }?;
    let content = ImportedContent { matrices, map };
    match content.matrices.to_sparse_structure(&content.map) {
        Ok(_) => Some(content),
        Err(error) => {
            v.complain("node_map", &format!("does not fit the matrices: {}", describe_mistake(&error)), None);
            None
        }
    }
}

/// Matrices of lines with row, column and value, in the rows' order of a node map.
fn triplets(v: &mut dyn Visit, import: &ImportedStructure, map: &NodeMap) -> Option<Imported> {
    if map.rows.is_empty() {
        v.complain(
            "node_map",
            "a line \"row NODE COMPONENT\" for each row: these matrices do not name their rows",
            None,
        );
        return None;
    }
    let rows = map.rows.len();
    visit_matrices(v, import, map, |v, key, from| read(v, key, &from.file, |text| read_triplets(text, rows)))
}

/// Returns the node map with the rows that the file of row names lists.
fn name_rows(v: &mut dyn Visit, import: &ImportedStructure, map: &NodeMap) -> Option<NodeMap> {
    let rows = read(v, "row_names", &import.row_names, read_rows)?;
    if !map.rows.is_empty() {
        v.complain("node_map", "no \"row\" lines, because row_names names the rows", None);
        return None;
    }
    Some(NodeMap { rows, ..map.clone() })
}

/// Returns whether the entries of the mass matrix name their nodes; `None` if there is nothing to read.
fn is_labelled(v: &mut dyn Visit, import: &ImportedStructure) -> Option<bool> {
    read(v, "mass_matrix", &import.mass.file, |text| Ok(has_labels(text)))
}

/// Returns a matrix of an OUTPUT4 file, text or binary, by its name.
fn op4_matrix(bytes: &[u8], name: &str) -> Result<Sparse, counterpoise_models::Error> {
    let refuse = |what: &str| counterpoise_models::Error::Import { line: 0, what: what.to_owned() };
    let all = if is_binary_op4(bytes) {
        read_binary_op4(bytes)?
    } else {
        let text = std::str::from_utf8(bytes);
        read_op4(text.map_err(|_| refuse("it is neither OUTPUT4 text nor a binary OUTPUT4 file"))?)?
    };
    let known: Vec<&str> = all.iter().map(|one| one.name.as_str()).collect();
    Ok(all[the_one(&known, name)?].matrix.clone())
}

fn dmig_matrix(text: &str, name: &str) -> Result<Dmig, counterpoise_models::Error> {
    let all = read_dmig(text)?;
    let known: Vec<&str> = all.iter().map(|one| one.name.as_str()).collect();
    Ok(all[the_one(&known, name)?].clone())
}

/// Matrices in the rows' order of the node map.
fn visit_matrices(
    v: &mut dyn Visit,
    import: &ImportedStructure,
    map: &NodeMap,
    mut matrix: impl FnMut(&mut dyn Visit, &str, &MatrixFile) -> Option<Sparse>,
) -> Option<Imported> {
    let (mass, stiffness) =
        (matrix(v, "mass_matrix", &import.mass), matrix(v, "stiffness_matrix", &import.stiffness));
    let damping = match import.damping.file.is_empty() {
        true => None,
        false => Some(matrix(v, "damping_matrix", &import.damping)?),
    };
    Some(Imported::from_row_order(map, mass?, damping, stiffness?))
}

/// Matrices that name their rows.
fn grids(
    v: &mut dyn Visit,
    import: &ImportedStructure,
    parse: impl Fn(&str, &str) -> Result<Dmig, counterpoise_models::Error>,
) -> Option<Imported> {
    let mut all: Vec<Dmig> = Vec::new();
    let mut named = Vec::new();
    for (key, from) in [
        ("mass_matrix", &import.mass),
        ("stiffness_matrix", &import.stiffness),
        ("damping_matrix", &import.damping),
    ] {
        if from.file.is_empty() {
            continue;
        }
        let inside = read(v, key, &from.file, |text| parse(text, &from.name))?;
        // names need not differ between files
        let name = format!("{key}:{}", inside.name);
        all.push(Dmig { name: name.clone(), ..inside });
        named.push(name);
    }
    let (mass, stiffness) = (named.first()?, named.get(1)?);
    match Imported::from_dmig(&all, mass, named.get(2).map(String::as_str), stiffness) {
        Ok(made) => Some(made),
        Err(error) => {
            v.complain("mass_matrix", &describe_mistake(&error), None);
            None
        }
    }
}

/// Returns the matrix of a name among those of a file, or the only one if no name is asked for.
fn the_one(known: &[&str], name: &str) -> Result<usize, counterpoise_models::Error> {
    let found = match (name, known.len()) {
        ("", 1) => Some(0),
        ("", _) => None,
        (name, _) => known.iter().position(|one| one.eq_ignore_ascii_case(name)),
    };
    let what = || match known {
        [] => "it holds no matrix".to_owned(),
        known => format!("it holds the matrices {}: name the one that is meant", known.join(", ")),
    };
    found.ok_or_else(|| counterpoise_models::Error::Import { line: 0, what: what() })
}

/// Returns a text parsed; `None` if there is nothing to read, or what is wrong has been said.
fn read<T>(
    v: &mut dyn Visit,
    key: &str,
    file: &str,
    parse: impl Fn(&str) -> Result<T, counterpoise_models::Error>,
) -> Option<T> {
    let parsed =
        v.attached_text(file)?.and_then(|text| parse(&text).map_err(|error| describe_mistake(&error)));
    accept(v, key, parsed)
}

/// Returns the bytes of a file parsed; `None` if there is nothing to read, or what is wrong has been said.
fn read_bytes<T>(
    v: &mut dyn Visit,
    key: &str,
    file: &str,
    parse: impl Fn(&[u8]) -> Result<T, counterpoise_models::Error>,
) -> Option<T> {
    let parsed =
        v.attached_bytes(file)?.and_then(|bytes| parse(&bytes).map_err(|error| describe_mistake(&error)));
    accept(v, key, parsed)
}

/// Returns what was parsed; says what is wrong with it.
fn accept<T>(v: &mut dyn Visit, key: &str, parsed: Result<T, String>) -> Option<T> {
    match parsed {
        Ok(value) => Some(value),
        Err(why) => {
            v.complain(key, &why, None);
            None
        }
    }
}

/// Returns a mistake in a file, with its line where one is to blame.
fn describe_mistake(error: &counterpoise_models::Error) -> String {
    match error {
        counterpoise_models::Error::Import { line: 0, what } => what.clone(),
        other => other.to_string(),
    }
}
