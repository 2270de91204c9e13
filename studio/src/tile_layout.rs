//! The layout of the plots of a page: tiles in rows, columns and tabs, as it is remembered for a project.

use std::collections::{BTreeMap, BTreeSet};

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

use crate::command::{DesignTab, Page, VerificationTab};

/// Smallest and largest share of a tile that is restored: beyond, a tile could not be gripped or would leave no room for others.
const SHARES: (f32, f32) = (0.02, 50.0);

/// A place whose plots are tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TilePlace {
    /// The tab Consequences of the page Design.
    Consequences,
    /// The tab Loop of the page Design.
    Loop,
    /// The tab Histories of the page Verify.
    Histories,
    /// The tab Rejection of the page Verify.
    Rejection,
}

/// A plot that is a tile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PlotTile {
    /// The key by which the plot is remembered.
    pub key: &'static str,
    /// The name on tabs and in menus.
    pub name: &'static str,
}

const fn tile(key: &'static str, name: &'static str) -> PlotTile {
    PlotTile { key, name }
}

const CONSEQUENCES: [PlotTile; 8] = [
    tile("weights", "Weights"),
    tile("loop-gain", "Loop gain"),
    tile("sensitivity", "Sensitivity"),
    tile("step", "Step of the demand"),
    tile("control", "Control effort"),
    tile("heave", "Heave"),
    tile("pitch", "Pitch"),
    tile("effort", "Error against effort"),
];
const LOOP: [PlotTile; 9] = [
    tile("loop-gain", "Loop gain"),
    tile("loop-phase", "Loop phase"),
    tile("nichols", "Nichols"),
    tile("nyquist", "Nyquist"),
    tile("root-locus", "Root locus"),
    tile("sensitivity", "Sensitivity"),
    tile("hub-for-demand", "Hub for the demand"),
    tile("hub-for-control", "Hub for 1 V on the control"),
    tile("control-for-noise", "Control for demand and noise"),
];
const HISTORIES: [PlotTile; 5] = [
    tile("hub", "Hub"),
    tile("control", "Control"),
    tile("drive", "Drive"),
    tile("tip", "Tip"),
    tile("mechanism", "Mechanism"),
];
const REJECTION: [PlotTile; 4] = [
    tile("heave", "Rejection of heave"),
    tile("pitch", "Rejection of pitch"),
    tile("loop-gain", "Loop gain"),
    tile("sensitivity", "Sensitivity"),
];

impl TilePlace {
    /// Returns the place that a page and its tabs show; `None` if its plots are no tiles.
    pub fn find(page: Page, design: DesignTab, verification: VerificationTab) -> Option<Self> {
        match (page, design, verification) {
            (Page::Design, DesignTab::Consequences, _) => Some(TilePlace::Consequences),
            (Page::Design, DesignTab::Loop, _) => Some(TilePlace::Loop),
            (Page::Verify, _, VerificationTab::Histories) => Some(TilePlace::Histories),
            (Page::Verify, _, VerificationTab::Rejection) => Some(TilePlace::Rejection),
            _ => None,
        }
    }

    /// Returns the plots of the place.
    pub fn plots(self) -> &'static [PlotTile] {
        match self {
            TilePlace::Consequences => &CONSEQUENCES,
            TilePlace::Loop => &LOOP,
            TilePlace::Histories => &HISTORIES,
            TilePlace::Rejection => &REJECTION,
        }
    }

    /// Returns the plot of a key.
    pub fn plot(self, key: &str) -> Option<PlotTile> {
        self.plots().iter().copied().find(|plot| plot.key == key)
    }

    /// Returns the usual layout.
    pub fn usual_layout(self) -> LayoutNode {
        let plot = |key: &str| LayoutNode::Plot(key.to_owned());
        let row = |keys: &[&str]| LayoutNode::even_row(keys.iter().map(|key| plot(key)).collect());
        let column = |nodes: Vec<LayoutNode>| {
            let shares = vec![1.0; nodes.len()];
            LayoutNode::Column { tiles: nodes, shares }
        };
        match self {
            TilePlace::Consequences => {
                let left =
                    column(vec![plot("weights"), row(&["sensitivity", "step"]), row(&["heave", "pitch"])]);
                let right = column(vec![plot("loop-gain"), plot("control"), plot("effort")]);
                LayoutNode::Row { tiles: vec![left, right], shares: vec![2.0, 1.0] }
            }
            TilePlace::Loop => column(vec![
                row(&["loop-gain", "loop-phase", "nichols"]),
                row(&["nyquist", "root-locus", "sensitivity"]),
                row(&["hub-for-demand", "hub-for-control", "control-for-noise"]),
            ]),
            TilePlace::Histories => {
                column(vec![row(&["hub", "control"]), row(&["drive", "tip", "mechanism"])])
            }
            TilePlace::Rejection => {
                column(vec![row(&["heave", "pitch"]), row(&["loop-gain", "sensitivity"])])
            }
        }
    }
}

/// A part of a layout.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LayoutNode {
    /// A plot.
    Plot(String),
    /// Parts beside each other.
    Row {
        /// The parts.
        tiles: Vec<LayoutNode>,
        /// Their shares of the width.
        shares: Vec<f32>,
    },
    /// Parts above each other.
    Column {
        /// The parts.
        tiles: Vec<LayoutNode>,
        /// Their shares of the height.
        shares: Vec<f32>,
    },
    /// Parts of which one is shown.
    Tabs {
        /// The parts.
        tiles: Vec<LayoutNode>,
        /// The number of the one that is shown, from 0.
        active: usize,
    },
}

impl LayoutNode {
    fn even_row(tiles: Vec<LayoutNode>) -> Self {
        let shares = vec![1.0; tiles.len()];
        LayoutNode::Row { tiles, shares }
    }

    fn tiles(&self) -> &[LayoutNode] {
        match self {
            LayoutNode::Plot(_) => &[],
            LayoutNode::Row { tiles, .. }
            | LayoutNode::Column { tiles, .. }
            | LayoutNode::Tabs { tiles, .. } => tiles,
        }
    }

    /// Returns whether a tab holds more than a plot.
    fn has_mixed_tabs(&self) -> bool {
        let is_plot = |node: &LayoutNode| matches!(node, LayoutNode::Plot(_));
        let is_mixed = matches!(self, LayoutNode::Tabs { tiles, .. } if !tiles.iter().all(is_plot));
        is_mixed || self.tiles().iter().any(LayoutNode::has_mixed_tabs)
    }

    /// Returns the layout without a plot; `None` if nothing is left.
    fn without(&self, key: &str) -> Option<Self> {
        let kept = |tiles: &[LayoutNode]| -> Vec<Option<LayoutNode>> {
            tiles.iter().map(|node| node.without(key)).collect()
        };
        let linear = |tiles: &[LayoutNode], shares: &[f32]| {
            let shares = shares.iter().copied().chain(std::iter::repeat(1.0));
            kept(tiles).into_iter().zip(shares).filter_map(|(node, share)| Some((node?, share))).unzip()
        };
        let node = match self {
            LayoutNode::Plot(own) => return (own != key).then(|| self.clone()),
            LayoutNode::Row { tiles, shares } => {
                let (tiles, shares) = linear(tiles, shares);
                LayoutNode::Row { tiles, shares }
            }
            LayoutNode::Column { tiles, shares } => {
                let (tiles, shares) = linear(tiles, shares);
                LayoutNode::Column { tiles, shares }
            }
            LayoutNode::Tabs { tiles, .. } => {
                LayoutNode::Tabs { tiles: kept(tiles).into_iter().flatten().collect(), active: 0 }
            }
        };
        (!node.tiles().is_empty()).then_some(node)
    }

    /// Returns the layout with a plot as a tab beside another one.
    fn with_tab(&self, target: &str, key: &str) -> Self {
        let all = |tiles: &[LayoutNode]| tiles.iter().map(|node| node.with_tab(target, key)).collect();
        match self {
            LayoutNode::Plot(own) if own == target => {
                LayoutNode::Tabs { tiles: vec![self.clone(), LayoutNode::Plot(key.to_owned())], active: 1 }
            }
            LayoutNode::Plot(_) => self.clone(),
            LayoutNode::Row { tiles, shares } => {
                LayoutNode::Row { tiles: all(tiles), shares: shares.clone() }
            }
            LayoutNode::Column { tiles, shares } => {
                LayoutNode::Column { tiles: all(tiles), shares: shares.clone() }
            }
            LayoutNode::Tabs { tiles, active } => LayoutNode::Tabs { tiles: all(tiles), active: *active },
        }
    }
}

/// A plot that fills its place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MaximisedPlot {
    /// The place.
    pub place: TilePlace,
    /// The key of the plot.
    pub key: String,
}

/// The layouts of all places.
#[derive(Debug, Default)]
pub struct PlotTiles {
    trees: BTreeMap<TilePlace, Tree<String>>,
    /// The plot that fills its place.
    pub maximised: Option<MaximisedPlot>,
    /// The key of the plot that was under the pointer last.
    pub pointed: Option<String>,
    /// What the button in the corner of the plot that is being drawn does; `None` if it is no tile.
    pub corner: Option<&'static str>,
}

impl PlotTiles {
    /// Returns the tree of a place, which is taken out until it is put back.
    pub fn take_tree(&mut self, place: TilePlace) -> Tree<String> {
        self.trees.remove(&place).unwrap_or_else(|| layout_tree(place, &place.usual_layout()))
    }

    /// Puts a tree back to its place.
    pub fn put_tree(&mut self, place: TilePlace, tree: Tree<String>) {
        self.trees.insert(place, tree);
    }

    /// Returns the key of the plot that fills a place; `None` if all are shown.
    pub fn maximised_at(&self, place: TilePlace) -> Option<String> {
        self.maximised.as_ref().filter(|one| one.place == place).map(|one| one.key.clone())
    }

    /// Lets a plot fill its place, or shows all again if one does.
    pub fn toggle_maximised(&mut self, place: TilePlace, key: &str) {
        self.maximised = match self.maximised_at(place) {
            Some(_) => None,
            None => place.plot(key).map(|plot| MaximisedPlot { place, key: plot.key.to_owned() }),
        };
    }

    /// Returns the plots of a place that are hidden.
    pub fn hidden_plots(&self, place: TilePlace) -> Vec<PlotTile> {
        let Some(tree) = self.trees.get(&place) else { return Vec::new() };
        let is_hidden = |plot: &&PlotTile| tree.tiles.find_pane(&plot.key.to_owned()).is_none();
        place.plots().iter().filter(is_hidden).copied().collect()
    }

    /// Removes a plot from its layout; the last one stays.
    pub fn hide_plot(&mut self, place: TilePlace, key: &str) {
        self.maximised = None;
        let mut tree = self.take_tree(place);
        let panes = tree.tiles.tiles().filter(|tile| tile.is_pane()).count();
        if let Some(tile) = tree.tiles.find_pane(&key.to_owned()).filter(|_| panes > 1) {
            tree.remove_recursively(tile);
        }
        self.put_tree(place, tree);
    }

    /// Shows a hidden plot, in a row below the others.
    pub fn show_plot(&mut self, place: TilePlace, key: &str) {
        let tree = self.take_tree(place);
        let is_hidden = tree.tiles.find_pane(&key.to_owned()).is_none();
        let layout = tree_layout(&tree).unwrap_or_else(|| place.usual_layout());
        let added = match layout {
            LayoutNode::Column { mut tiles, mut shares } => {
                tiles.push(LayoutNode::Plot(key.to_owned()));
                shares.push(shares.iter().sum::<f32>() / shares.len().max(1) as f32);
                LayoutNode::Column { tiles, shares }
            }
            other => LayoutNode::Column {
                tiles: vec![other, LayoutNode::Plot(key.to_owned())],
                shares: vec![2.0, 1.0],
            },
        };
        let tree = if is_hidden { layout_tree(place, &added) } else { tree };
        self.put_tree(place, tree);
    }

    /// Gives a place its usual layout.
    pub fn reset(&mut self, place: TilePlace) {
        self.trees.remove(&place);
        self.maximised = None;
    }

    /// Returns the layouts that differ from the usual ones.
    pub fn layouts(&self) -> BTreeMap<TilePlace, LayoutNode> {
        let own = |(place, tree): (&TilePlace, &Tree<String>)| {
            let layout = tree_layout(tree).filter(|layout| *layout != place.usual_layout())?;
            Some((*place, layout))
        };
        self.trees.iter().filter_map(own).collect()
    }

    /// Takes over layouts that were remembered.
    pub fn set_layouts(&mut self, layouts: &BTreeMap<TilePlace, LayoutNode>) {
        self.trees = layouts.iter().map(|(place, layout)| (*place, layout_tree(*place, layout))).collect();
        self.maximised = None;
    }
}

/// Returns a layout as a tree. Plots that the place lacks and second ones of a kind are left out; a layout without any is the usual one.
fn layout_tree(place: TilePlace, layout: &LayoutNode) -> Tree<String> {
    let id = egui::Id::unique(("plots", place));
    let plant = |layout: &LayoutNode| {
        let mut planter = TreePlanter { place, tiles: Tiles::default(), planted: BTreeSet::new() };
        let root = planter.plant(layout)?;
        Some(Tree::new(id, root, planter.tiles))
    };
    plant(layout).or_else(|| plant(&place.usual_layout())).unwrap_or_else(|| Tree::empty(id))
}

/// A tree as it is made of a layout.
struct TreePlanter {
    place: TilePlace,
    tiles: Tiles<String>,
    planted: BTreeSet<String>,
}

impl TreePlanter {
    fn plant(&mut self, node: &LayoutNode) -> Option<TileId> {
        match node {
            LayoutNode::Plot(key) => {
                let is_new = self.place.plot(key).is_some() && self.planted.insert(key.clone());
                is_new.then(|| self.tiles.insert_pane(key.clone()))
            }
            LayoutNode::Row { tiles, shares } => self.plant_linear(LinearDir::Horizontal, tiles, shares),
            LayoutNode::Column { tiles, shares } => self.plant_linear(LinearDir::Vertical, tiles, shares),
            LayoutNode::Tabs { tiles, active } => {
                let children: Vec<TileId> = tiles.iter().filter_map(|node| self.plant(node)).collect();
                let mut tabs = Tabs::new(children.clone());
                if let Some(child) = children.get(*active) {
                    tabs.set_active(*child);
                }
                (!children.is_empty()).then(|| self.tiles.insert_container(tabs))
            }
        }
    }

    fn plant_linear(&mut self, dir: LinearDir, nodes: &[LayoutNode], shares: &[f32]) -> Option<TileId> {
        let shares = shares.iter().copied().chain(std::iter::repeat(1.0));
        let mut linear = Linear::new(dir, Vec::new());
        for (node, share) in nodes.iter().zip(shares) {
            let Some(child) = self.plant(node) else { continue };
            linear.add_child(child);
            let share = if share.is_finite() { share.clamp(SHARES.0, SHARES.1) } else { 1.0 };
            linear.shares.set_share(child, share);
        }
        (!linear.children.is_empty()).then(|| self.tiles.insert_container(linear))
    }
}

/// A plot that was let go over others.
pub struct PlotDrop<'a> {
    /// The tree before.
    pub before: &'a Tree<String>,
    /// The tree after, as the library has it.
    pub after: &'a Tree<String>,
    /// The tile that was dragged.
    pub dragged: TileId,
    /// Where it was let go.
    pub at: egui::Pos2,
}

/// Returns the tree in which a plot is a tab beside the plot on which it was let go, if the library made it a tab beside a whole row or column;
/// `None` if it did not.
pub fn repair_drop(place: TilePlace, drop: &PlotDrop) -> Option<Tree<String>> {
    if !tree_layout(drop.after)?.has_mixed_tabs() {
        return None;
    }
    let before = tree_layout(drop.before)?;
    let key = drop.before.tiles.get_pane(&drop.dragged);
    let is_target = |id: &TileId| {
        *id != drop.dragged && drop.before.tiles.rect(*id).is_some_and(|area| area.contains(drop.at))
    };
    let mut targets = drop.before.tiles.tile_ids().filter(is_target);
    let target = targets.find_map(|id| drop.before.tiles.get_pane(&id));
    let layout = match (key, target) {
        (Some(key), Some(target)) => before.without(key).map(|rest| rest.with_tab(target, key)),
        _ => None,
    };
    Some(layout_tree(place, &layout.unwrap_or(before)))
}

/// Returns the layout of a tree; `None` if it is empty.
fn tree_layout(tree: &Tree<String>) -> Option<LayoutNode> {
    tile_layout(&tree.tiles, tree.root()?)
}

fn tile_layout(tiles: &Tiles<String>, id: TileId) -> Option<LayoutNode> {
    let container = match tiles.get(id)? {
        Tile::Pane(key) => return Some(LayoutNode::Plot(key.clone())),
        Tile::Container(container) => container,
    };
    let children = container.children_vec();
    let nodes: Vec<LayoutNode> = children.iter().filter_map(|child| tile_layout(tiles, *child)).collect();
    Some(match container {
        Container::Linear(linear) => {
            let shares = children.iter().map(|child| linear.shares[*child]).collect();
            match linear.dir {
                LinearDir::Horizontal => LayoutNode::Row { tiles: nodes, shares },
                LinearDir::Vertical => LayoutNode::Column { tiles: nodes, shares },
            }
        }
        Container::Tabs(tabs) => {
            let active = children.iter().position(|child| Some(*child) == tabs.active).unwrap_or_default();
            LayoutNode::Tabs { tiles: nodes, active }
        }
        Container::Grid(_) => LayoutNode::even_row(nodes),
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    const PLACES: [TilePlace; 4] =
        [TilePlace::Consequences, TilePlace::Loop, TilePlace::Histories, TilePlace::Rejection];

    #[test]
    fn a_layout_comes_back_from_its_tree_and_every_usual_one_has_every_plot() {
        for place in PLACES {
            let tree = layout_tree(place, &place.usual_layout());
            assert_eq!(tree_layout(&tree).unwrap(), place.usual_layout());
            assert!(place.plots().iter().all(|plot| tree.tiles.find_pane(&plot.key.to_owned()).is_some()));
        }
        let plot = |key: &str| LayoutNode::Plot(key.to_owned());
        let tabs = LayoutNode::Tabs { tiles: vec![plot("tip"), plot("hub")], active: 1 };
        let own = LayoutNode::Row { tiles: vec![tabs, plot("drive")], shares: vec![3.0, 1.5] };
        assert_eq!(tree_layout(&layout_tree(TilePlace::Histories, &own)).unwrap(), own);
        let text = serde_json::to_string(&own).unwrap();
        assert_eq!(serde_json::from_str::<LayoutNode>(&text).unwrap(), own);
    }

    #[test]
    fn a_damaged_layout_keeps_what_can_be_shown() {
        let plot = |key: &str| LayoutNode::Plot(key.to_owned());
        let tiles = vec![plot("hub"), plot("hub"), plot("unknown"), LayoutNode::even_row(Vec::new())];
        let damaged = LayoutNode::Row { tiles, shares: vec![f32::NAN, 1e9] };
        let expected = LayoutNode::Row { tiles: vec![plot("hub")], shares: vec![1.0] };
        assert_eq!(tree_layout(&layout_tree(TilePlace::Histories, &damaged)).unwrap(), expected);
        let nothing = layout_tree(TilePlace::Histories, &plot("unknown"));
        assert_eq!(tree_layout(&nothing).unwrap(), TilePlace::Histories.usual_layout());
    }

    #[test]
    fn plots_are_hidden_and_shown_again_and_the_last_one_stays() {
        let mut tiles = PlotTiles::default();
        let place = TilePlace::Histories;
        for key in ["mechanism", "tip", "drive", "control", "hub"] {
            tiles.hide_plot(place, key);
        }
        let hidden: Vec<&str> = tiles.hidden_plots(place).iter().map(|plot| plot.key).collect();
        assert_eq!(hidden, ["control", "drive", "tip", "mechanism"]);
        tiles.show_plot(place, "tip");
        assert_eq!(tiles.hidden_plots(place).len(), 3);
        assert!(tiles.layouts().contains_key(&place));
        tiles.reset(place);
        assert!(tiles.layouts().is_empty() && tiles.hidden_plots(place).is_empty());
    }
}
