//! Scenes on the GPU whose triangles move, and hierarchies that it builds.

use eyerays_shader::resources::binding;
use glam::Vec3;

use super::Renderer;
use crate::error::Result;
use crate::gpu::linear::Linear;
use crate::gpu::refit::Moving;
use crate::scene::Scene;

impl Renderer {
    /// Goes on with the vertices of the scene that was packed elsewhere, in world units, and with their normals if it has any (thesis
    /// 4.1.1). Its hierarchy is fitted to them on the device, and stays as good as they stay near to each other: where they do not,
    /// [`Job::moved`](crate::job::Job::moved) tells when it is better built anew. `scene` is what was packed; only its triangles are read, and only once.
    ///
    /// # Errors
    /// What can't be moved so: all but triangles that are not split, shine or have tangents. Vertices out of the box that the scene was
    /// packed in, or what the GPU reports.
    pub fn deform(&mut self, scene: &Scene, positions: &[Vec3], normals: &[Vec3]) -> Result<()> {
        let layout = self.traversal.layout;
        if self.job.is_left_open() && self.linear.is_none() {
            self.rebuild()?;
        }
        let moving = match self.moving.take() {
            Some(moving) => moving,
            None => Moving::new(&self.gpu, &self.job, layout, scene, &self.scene)?,
        };
        let moving = self.moving.insert(moving);
        moving.go((&self.gpu, &self.job), self.linear.as_ref(), positions, normals)
    }

    /// Builds a hierarchy on the device, of its triangles where they are, in the place of the one that the scene was packed with: sooner
    /// than any other, and less good. What is deformed afterwards is fitted into it. A film that was started is then to be started again.
    ///
    /// # Errors
    /// A scene of more than triangles, or of fewer than two; another layout than the plain one; or what the GPU reports.
    pub fn rebuild(&mut self) -> Result<()> {
        let linear = match self.linear.take() {
            Some(linear) => linear,
            None => {
                let linear = Linear::new(&self.gpu, &self.job, self.traversal.layout, &self.scene)?;
                // The groups bind the nodes that there were.
                (self.memory, self.growing, self.cells) = (None, None, None);
                self.scene.replace(binding::NODES, linear.nodes().clone());
                linear
            }
        };
        // Kept whatever comes of it: the nodes are its own.
        self.linear.insert(linear).go(&self.gpu)
    }

    /// Waits until the device has done all that was asked of it.
    ///
    /// # Errors
    /// What the GPU reports.
    pub fn wait(&mut self) -> Result<()> {
        self.gpu.wait()
    }
}
