//! Light cameras against those that OGRE 1.12.10 computed: where it is right they agree, and where it is wrong they have the property that its own lack.
//!
//! The numbers are OGRE's own, in single precision (`data/ogre-1.12.10.json`). Matrices are compared by what they do to points, in NDC: their entries may differ by a factor.

mod data;
mod bodies;
mod lispsm;
mod oddities;
mod plane_optimal;
mod splits;
mod uniform;
