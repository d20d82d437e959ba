//! The explorer driven through its accessibility tree: no display, no GPU.

mod files;
mod keyboard;
mod pages;
mod picture;
mod pixels;
mod window;
