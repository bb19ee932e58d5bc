//! The fits of light cameras: what must hold of every plan, by random scenes and by brute force, and what each fit is by its closed form.

mod cascades;
mod cover;
mod outcomes;
mod pancake;
mod plane_optimal;
mod rays;
mod scenes;
mod stabilised;
mod warps;
