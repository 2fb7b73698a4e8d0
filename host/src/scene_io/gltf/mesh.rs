//! The meshes of all nodes as one, in world units.

use eyerays_shader::geometry;
use glam::{DMat3, DMat4, Vec2, Vec3, Vec4};

use super::accessor::Accessors;
use super::document::{self, Document, pick};
use super::instance;
use super::morph;
use super::node::Placed;
use super::notes::Notes;
use super::primitive::{Mode, Plan, Primitive, Shape};
use super::skin::{Pose, Skins};
use crate::scene;
use crate::scene::{MAX_PRIMITIVES, Mesh, Primitives, Unplaced, extent};
use crate::scene_io::budget::Budget;
use crate::scene_io::copies::Copies;
use crate::scene_io::transform::exact;

/// All that is placed so far.
pub struct Merge<'f> {
    document: &'f Document,
    accessors: Accessors<'f>,
    skins: Skins<'f>,
    budget: Budget,
    mesh: Mesh,
    copies: Copies,
    objects: Vec<scene::Object>,
    /// Of what was placed or looked at, so that what draws nothing is not free.
    triangles: usize,
    vertices: usize,
    /// Copies of meshes.
    places: usize,
}

/// What a copy of a mesh takes of memory from its file to the picture, in bytes.
const PLACE: u64 = 512;

/// A primitive that was read, for all its places.
struct Part {
    primitive: Primitive,
    material: u32,
    /// Its JSON path.
    here: String,
}

/// Where a primitive is put.
struct Place<'p> {
    world: DMat4,
    /// In place of `world`, at a node with a skin.
    pose: Option<&'p Pose>,
    /// The number of the node.
    node: usize,
}

impl<'f> Merge<'f> {
    /// Nothing yet, within the budget.
    pub fn new(document: &'f Document, accessors: Accessors<'f>, skins: Skins<'f>, budget: Budget) -> Self {
        Merge {
            document,
            accessors,
            skins,
            budget,
            mesh: Mesh::default(),
            copies: Copies::default(),
            objects: Vec::new(),
            triangles: 0,
            vertices: 0,
            places: 0,
        }
    }

    /// Adds the mesh of a number at all of some nodes that have it, whose morph targets have the same weights, and whether it is kept to
    /// be moved. A mesh is read once, and is gone before the next.
    ///
    /// # Errors
    /// There is no such mesh, it makes no sense, or it is too large.
    pub fn add(&mut self, number: usize, (nodes, is_kept): (&[&Placed], bool), notes: &mut Notes) -> Unplaced<()> {
        let Some(first) = nodes.first() else { return Ok(()) };
        let owner = format!("nodes[{}].mesh", first.number);
        let mesh = pick(&self.document.meshes, number, &owner, "mesh")?;
        let shape = Shape {
            weights: morph::weights(first, mesh),
            is_skinned: nodes.iter().any(|placed| placed.node.skin.is_some()),
        };
        let mut copies = 0usize;
        for placed in nodes {
            copies = copies.saturating_add(instance::Copies::of(placed, &self.accessors)?.count);
        }
        // What joints move has another shape in each place.
        let is_shared = (copies > 1 || is_kept) && !shape.is_skinned;
        if is_shared {
            self.places = self.places.saturating_add(copies);
            let fits = self.budget.check_bytes((self.places as u64).saturating_mul(PLACE));
            fits.map_err(|why| format!("{owner}: {} copies of a mesh {why}; use fewer", self.places))?;
        }
        let mut primitives = Vec::new();
        for (part, of) in mesh.primitives.iter().enumerate() {
            let here = format!("meshes[{number}].primitives[{part}]");
            morph::note(of, notes);
            let Some((mode, positions)) = drawn(of, &here, notes)? else { continue };
            let material = self.material(of, &here)?;
            let plan = Plan::new(of, positions, mode, &self.accessors, &here)?;
            // It is read even if it has no place.
            self.count(&plan, if is_shared { 1 } else { copies.max(1) }).map_err(|fault| format!("{here}: {fault}"))?;
            let primitive = plan.read(of, &shape, &self.accessors, &here)?;
            primitives.push(Part { primitive, material, here });
        }
        if primitives.is_empty() {
            return Ok(());
        }
        if is_shared {
            return self.share(&primitives, nodes, mesh.name.as_deref());
        }
        nodes.iter().try_for_each(|placed| self.place_all(&primitives, placed, mesh.name.as_deref()))
    }

    /// Puts a mesh where several nodes have it, or one in several places: once, and where it stands.
    fn share(&mut self, primitives: &[Part], nodes: &[&Placed], of_mesh: Option<&str>) -> Unplaced<()> {
        let own = std::mem::take(&mut self.mesh);
        let here = Place { world: DMat4::IDENTITY, pose: None, node: nodes[0].number };
        for part in primitives {
            self.place(part, &here).map_err(|fault| format!("{}: {fault}", part.here))?;
        }
        let mesh = std::mem::replace(&mut self.mesh, own);
        if mesh.triangles.is_empty() {
            return Ok(());
        }
        let [least, greatest] = mesh.bounds().map(Vec3::abs);
        let (number, reach) = (self.copies.meshes.len(), least.max(greatest));
        self.copies.meshes.push(mesh);
        for placed in nodes {
            let copies = instance::Copies::of(placed, &self.accessors)?;
            let first = self.copies.places.len();
            for world in copies.worlds() {
                let farthest = Transform::new(world).reach(reach);
                if !farthest.is_finite() {
                    return Err(format!("nodes[{}] takes it out of single precision; make it smaller", placed.number));
                }
                self.copies.places.push((number, world));
            }
            let primitives = Primitives::Instances(first..self.copies.places.len());
            if primitives.count() > 0 {
                let (bounds, visibility) = (Default::default(), scene::Visibility::default());
                self.objects.push(scene::Object { name: name(placed, of_mesh), primitives, bounds, visibility });
            }
        }
        Ok(())
    }

    /// The number that a primitive's material has in the scene, whose first is for what names none.
    fn material(&self, of: &document::Primitive, here: &str) -> Unplaced<u32> {
        let Some(material) = of.material else { return Ok(0) };
        pick(&self.document.materials, material, &format!("{here}.material"), "material")?;
        Ok(u32::try_from(material + 1).unwrap_or(0))
    }

    /// Puts a mesh where a node has it.
    fn place_all(&mut self, primitives: &[Part], placed: &Placed, of_mesh: Option<&str>) -> Unplaced<()> {
        let (triangle, vertex) = (self.mesh.triangles.len(), self.mesh.positions.len());
        let pose = self.skins.pose(placed, &self.accessors, &self.budget)?;
        let copies = instance::Copies::of(placed, &self.accessors)?;
        for world in copies.worlds() {
            let at = Place { world, pose: pose.as_deref(), node: placed.number };
            for part in primitives {
                self.place(part, &at).map_err(|fault| format!("{}: {fault}", part.here))?;
            }
            if pose.is_some() {
                // Joints alone say where it is.
                break;
            }
        }
        let triangles = triangle..self.mesh.triangles.len();
        if !triangles.is_empty() {
            let bounds = extent::of(self.mesh.positions[vertex..].iter().copied());
            let name = name(placed, of_mesh);
            let (primitives, visibility) = (Primitives::Triangles(triangles), scene::Visibility::default());
            self.objects.push(scene::Object { name, primitives, bounds, visibility });
        }
        Ok(())
    }

    /// Refuses too much before anything is read or allocated for it.
    fn count(&mut self, plan: &Plan, nodes: usize) -> Unplaced<()> {
        let triangles = plan.triangles.saturating_mul(nodes).saturating_add(self.triangles);
        // One more for each node: even what is empty takes its time.
        let vertices = plan.vertices.saturating_add(1).saturating_mul(nodes).saturating_add(self.vertices);
        let most = 4 * MAX_PRIMITIVES;
        if triangles > most || vertices > most {
            let fault = format!("{triangles} triangles with {vertices} vertices in all are more than a scene may have");
            return Err(format!("{fault}; use fewer"));
        }
        (self.triangles, self.vertices) = (triangles, vertices);
        self.budget.check(triangles, vertices)
    }

    fn place(&mut self, Part { primitive: of, material, .. }: &Part, at: &Place) -> Unplaced<()> {
        let rigid = Transform::new(at.world);
        let transform = |vertex: usize| match at.pose {
            Some(pose) => Transform::new(pose.world(&of.bond, vertex)),
            None => rigid,
        };
        let before = self.mesh.positions.len();
        let after = before + of.positions.len();
        let range = (before, after);
        self.mesh
            .positions
            .extend(of.positions.iter().enumerate().map(|(vertex, &position)| transform(vertex).position(position)));
        let is_finite = self.mesh.positions.iter().skip(before).all(|position| position.is_finite());
        if !is_finite {
            return Err(format!("nodes[{}] takes it out of single precision; make it smaller", at.node));
        }
        put(
            &mut self.mesh.normals,
            of.normals.iter().enumerate().map(|(vertex, &normal)| transform(vertex).normal(normal)),
            range,
            Vec3::ZERO,
        );
        put(
            &mut self.mesh.tangents,
            of.tangents.iter().enumerate().map(|(vertex, &tangent)| transform(vertex).tangent(tangent)),
            range,
            Vec4::ZERO,
        );
        for (all, more) in self.mesh.coordinates.iter_mut().zip(&of.coordinates) {
            put(all, more.iter().copied(), range, Vec2::ZERO);
        }
        put(&mut self.mesh.colours, of.colours.iter().copied(), range, Vec4::ONE);
        let first = u32::try_from(before).map_err(|_| "there are too many vertices; use fewer")?;
        self.mesh.triangles.extend(of.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| first + vertex);
            if transform(triangle[0] as usize).is_mirror() { [a, c, b] } else { [a, b, c] }
        }));
        self.mesh.materials.resize(self.mesh.triangles.len(), *material);
        Ok(())
    }

    /// All of it, and what each node has of it.
    pub fn finish(self) -> (Mesh, Copies, Vec<scene::Object>) {
        (self.mesh, self.copies, self.objects)
    }
}

/// How the corners of a primitive make triangles, and the list of its positions; none of what is not drawn.
fn drawn(of: &document::Primitive, here: &str, notes: &mut Notes) -> Unplaced<Option<(Mode, usize)>> {
    let Some(mode) = Mode::from_code(of.mode).map_err(|fault| format!("{here}.{fault}"))? else {
        notes.left_out("mode", "points and lines are left out: only triangles are drawn");
        return Ok(None);
    };
    let Some(&positions) = of.attributes.get("POSITION") else {
        notes.left_out("POSITION", &format!("{here} is left out, and others like it: it has no POSITION"));
        return Ok(None);
    };
    Ok(Some((mode, positions)))
}

/// What a node is called: by its own name, its mesh's or its number.
fn name(placed: &Placed, of_mesh: Option<&str>) -> String {
    let names = [placed.node.name.as_deref(), of_mesh];
    let name = names.into_iter().flatten().find(|name| !name.is_empty());
    name.map_or_else(|| format!("node {}", placed.number), str::to_owned)
}

/// Adds what more vertices have, and `none` for those that have nothing; nothing as long as none has anything.
fn put<T: Copy>(all: &mut Vec<T>, more: impl ExactSizeIterator<Item = T>, (before, after): (usize, usize), none: T) {
    if all.is_empty() && more.len() == 0 {
        return;
    }
    all.resize(before, none);
    all.extend(more);
    all.resize(after, none);
}

/// Where a node puts what it has.
#[derive(Clone, Copy)]
struct Transform(geometry::Transform);

impl Transform {
    fn new(world: DMat4) -> Self {
        Transform(exact(&DMat3::from_mat4(world), world.w_axis.truncate()))
    }

    fn is_mirror(&self) -> bool {
        self.0.side < 0.0
    }

    fn position(&self, position: Vec3) -> Vec3 {
        self.0.place(position)
    }

    /// How far what reaches so far from the origin of its own units may be from the world's.
    fn reach(&self, reach: Vec3) -> Vec3 {
        let geometry::Transform { x, y, z, translation, .. } = self.0;
        self.0.place(Vec3::ZERO).abs()
            + Vec3::new(x.abs().dot(reach), y.abs().dot(reach), z.abs().dot(reach))
            + translation.abs()
    }

    fn normal(&self, of: Vec3) -> Vec3 {
        self.0.normal(of)
    }

    /// The bitangent's sign turns where the node mirrors. Without a direction all is zero, which is none.
    fn tangent(&self, tangent: Vec4) -> Vec4 {
        let unit = self.0.direction(tangent.truncate());
        if unit == Vec3::ZERO {
            return Vec4::ZERO;
        }
        let is_turned = (tangent.w < 0.0) != self.is_mirror();
        unit.extend(if is_turned { -1.0 } else { 1.0 })
    }
}
