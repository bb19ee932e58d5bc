#!/bin/sh
# Draws the pictures of docs/gallery.md again, with the program as it is: run it from the top of the repository.
set -eu
cargo build --release --locked --quiet -p shadow-cli
shadow=target/release/shadow
out=docs/images/gallery
sun='directional:dir=-0.4,-1,0.3;lux=10000'
lamp='point:pos=-1,2.6,1.5;cd=4000'
draw() {
    name=$1
    shift
    "$shadow" render builtin:demo --size 480x270 --output "$out/$name.png" "$@" >/dev/null
}
draw color
draw mini-screen --show mini-screen
draw light-view --show light-view --map-size 270
draw depth --show depth
draw distance-match --show distance-match
draw unshadowed --show unshadowed
draw shadows --show shadows
draw texels --show texels --map-size 128
draw bias --show bias --map-size 256
draw taps --show taps --filter footprint --map-size 1024
draw aliasing --show aliasing --map-size 1024
draw cause --show cause --bias constant --bias-constant 0.05 --map-size 512
draw additive --light "$sun" --light "$lamp" --composition additive
draw modulative --light "$sun" --light "$lamp" --composition modulative
draw picture --light 'spot:pos=0,6,3;dir=0,-1,-0.4;inner=33;outer=35;cd=9000;picture=docs/images/slide.png'
