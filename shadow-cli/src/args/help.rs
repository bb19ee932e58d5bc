//! The longer texts of the program's help: examples, and what reports and pictures mean.

/// Examples for the program as a whole.
pub(super) const EXAMPLES: &str = "\
Examples:
  shadow                                        draw the built-in demo scene to shadow.png
  shadow render house.glb --size 1920x1080      draw a scene with its own camera and lights
  shadow render house.glb --show shadow-map:0   look at the shadow map of the first light
  shadow compare house.glb                      do the CPU and the GPU renderer agree?
  shadow bench house.glb                        how long does each of them take?
  shadow info house.glb                         what is in the file?
  shadow plan house.glb --json                  every matrix, texel size and bias
  shadow measure house.glb --report report      how wrong are its shadows, and why?
  shadow tune house.glb                         is the bias enough, and how wide are its gaps?
  shadow devices                                which graphics adapters there are
  shadow probe                                  what does the adapter do where it has a choice?

`shadow help COMMAND` explains a command's options.
Exit codes: 0 done, 1 the thing asked about is not so (a comparison failed), 2 the request or the input is wrong,
130 interrupted (Ctrl-C, or told to end); no half-written file stays behind, whatever the code.";

/// Examples for `shadow render`.
pub(super) const RENDER_EXAMPLES: &str = "\
Examples:
  shadow render house.glb --output house.png
  shadow render house.glb --backend gpu --adapter llvmpipe --size 1920x1080
  shadow render house.glb --camera 'eye=4,2,6;target=0,1,0;fov=50' --exposure 13
  shadow render house.glb --light 'directional:dir=-1,-2,-1;lux=20000'
  shadow render house.glb --light 'spot:pos=2,3,1;dir=0,-1,0;inner=20;outer=30;cd=800' --show visibility
  shadow render builtin:fence --filter hard --bias none --show shadow-map
  shadow render house.glb --show depth --output depth.exr
  shadow render house.glb --backend trace --light 'directional:dir=-1,-2,-1;lux=20000;diameter=3'
  shadow render fox.glb --animation Run --time 0.5 --memory-limit 2GiB
  shadow render house.glb --preset godot                      # with an engine's defaults
  shadow render house.glb --json | jq .milliseconds";

/// Examples for `shadow compare`.
pub(super) const COMPARE_EXAMPLES: &str = "\
Examples:
  shadow compare
  shadow compare house.glb --size 640x360 --map-size 1024
  shadow compare house.glb --light 'point:pos=0,2,0;cd=500' --output differences
  shadow compare house.glb --json | jq '.layers[] | select(.within_contract | not)'";

/// What to look at in the report of `shadow bench`, and examples.
pub(super) const BENCH_HELP: &str = "\
What to look at:
  The backends draw in turn (cpu, gpu, cpu, gpu, ...), after a first frame of
  each and a round that are not counted, so that whatever disturbs the machine
  disturbs both.

  median      what a frame takes on this machine as it is now; compare medians
  quartiles   half of the frames lie between them. Where they are far apart the
              machine was busy: close other programs, or take more --frames
  fastest     what the machine can do when nothing disturbs it
  ratio       of the times of the same round, so that it holds still where
              the times do not; above 1 the second backend is the slower one
  once        opening (threads, or the adapter and its shaders), preparing the
              scene, and the first frame, in which drivers compile for the
              machine: paid once, and not part of a frame
  memory      the most physical memory that the process held at once beyond
              what it held before the backend was opened, until its first
              frame was drawn: the scene in the backend's own form, the maps
              and the frame, threads, driver and compiled shaders. A software
              adapter's memory is counted, that of a graphics card is not.
              Linux tells; elsewhere it is left out

  rays        the trace backend sends a ray through every pixel (camera) and one
              to each light from each surface that faces it (shading); millions
              of them a second, by the medians

  A software adapter (llvmpipe, SwiftShader) runs on the same cores as the cpu
  backend: the ratio then compares two programs, and no graphics card.

Examples:
  shadow bench
  shadow bench house.glb --size 1920x1080 --frames 50
  shadow bench house.glb --backends cpu --threads 1
  shadow bench house.glb --backends trace
  shadow bench house.glb --filters bilinear,box5,witness7 --backends cpu
  shadow bench house.glb --json | jq .ratios.total";

/// Examples for `shadow info`.
pub(super) const INFO_EXAMPLES: &str = "\
Examples:
  shadow info house.glb
  shadow info fox.glb --animation Run --time 0.5
  shadow info house.glb --json | jq '.materials, .units_guess'";

/// Examples for `shadow plan`.
pub(super) const PLAN_EXAMPLES: &str = "\
Examples:
  shadow plan house.glb --map-size 4096
  shadow plan house.glb --json | jq -r .camera.spec      # to copy, vary and give to --camera
  shadow plan house.glb --json | jq '.lights[0].views[0].texel_metres'";

/// What the causes of `shadow measure` are, and examples.
pub(super) const MEASURE_HELP: &str = "\
Why a pixel is wrong (its visibility is not exactly that of the light's
centre), the first of these that applies:

  coverage       renderer and rays see different triangles there, or a sliver
                 was drawn into the map at a depth that nothing has there
  terminator     the shading normal and the geometric one disagree about
                 facing the light
  seam           a tap leaves its cube face, or the map
  filter         the true outline runs between the taps, which are mixed
  aliasing       the true outline runs between the taps, and the lookup is on
                 the wrong side of it
  acne           the pixel and all taps see the light: the surface shadows
                 itself
  peter_panning  the pixel and all taps are in shadow, whose caster is nearer
                 than the bias
  leak           the same, and its caster is farther than the bias

A tap is judged by rays from the receiver's plane, where the light's ray
through the middle of its texel meets it.

rmse is the root of the mean squared error of visibility against the light's
whole size (see --light). Stability is the share of points of the surfaces
whose visibility changes for no reason while the camera moves by a third of a
texel, turns by 0.1 degrees or zooms by 1 %, or the light moves a little; the
column unstable is the worst of the first three, and --json has all of them.

m is over how many pixels one texel of a map smears, in the direction in which
it is longest: the largest singular value of d(pixel) / d(texel) on the
surface. Where m is at most 1, outlines are off by at most 0.71 pixel. m 95 %
is what 95 of 100 pixels stay below, m > 1 the share of pixels where it is more
than that; what the light grazes (a cosine of at most 0.1) is left out, for m
has no bound there. waste is the share of the maps' texels that no pixel sees.
shadow render --show aliasing draws m.

Examples:
  shadow measure house.glb
  shadow settings > soft.toml                        # and change what is in it
  shadow measure house.glb --settings hard.toml --settings soft.toml --report report
  shadow measure house.glb --bias constant --json | jq '.techniques[].causes'
  shadow measure house.glb --preset bevy             # with an engine's defaults";

/// What the columns of `shadow tune` are, and examples.
pub(super) const TUNE_HELP: &str = "\
What the columns mean, light by light:

  acne            pixels that shadow themselves, though they and all taps of
                  their lookup see the light
  lit wrongly     pixels that are lit though they and all taps of their lookup
                  are in shadow: peter panning, where what shadows them is
                  nearer than the bias, and leaks
  gap             how far from the foot of a wall its shadow would begin: of
                  all pixels that ask a map the median, and what 95 of 100
                  stay below; all, where nothing is shadowed any more
  wider           the share of these pixels whose gap is wider than that of the
                  automatic bias by more than 2 %
  shift           how far outlines of distant casters are moved along the
                  surface: the price of a step along the normal
  longer          the share of pixels whose shift is longer than that of the
                  automatic bias
  fails           acne, where there is any; light, where more than twice as
                  many pixels are lit wrongly as with the automatic bias; gap or
                  shift, where the share of pixels with more of it than needed
                  is above 5 %

What slivers do to a map, in whose texels they can be drawn at any depth, is no
bias's fault: it is counted apart.

Biases are tried on the same maps, with the same filter, for they are a matter
of the receivers alone. Each engine's default is taken in its own units; what
the engine does beside it (its filter, fit and cascades) is not part of it. An
engine with an asterisk draws the back faces of single-sided casters, and is
tried on a map of these.

The constant bias that was tuned is the least that leaves this picture without
acne, found by halving: what a patient hand would arrive at, for this camera
and this light. The automatic bias knows neither the picture nor the scene.

Examples:
  shadow tune house.glb
  shadow tune house.glb --map-size 512 --filter hard --output hard.html
  shadow tune house.glb --light 'point:pos=0,2,0;cd=500' --backend gpu
  shadow tune house.glb --json --output house.json | jq '.lights[].rules[] | {name, fails}'";

/// What `shadow settings --convert` takes and says, and examples.
pub(super) const SETTINGS_HELP: &str = "\
What --convert takes: ENGINE, which stands for the engine's defaults, or
ENGINE:NAME=VALUE;NAME=VALUE, where what is left out is 0. The names are the
engines' own:

  metres     constant (metres toward the light), normal (metres along the
             normal), slope (texels times the tangent)
  ogre-2006  units
  ogre-1.12  fixed (fixedDepthBias)
  ogre-13    constant, slope (both of depth_bias, away from the light)
  mjp        bias, offsetScale
  filament   constantBias, normalBias, polygonOffsetConstant,
             polygonOffsetSlope
  bevy       depth (shadow_depth_bias), normal (shadow_normal_bias)
  three      bias (at most 0), normalBias
  babylon    bias, normalBias
  godot      bias (shadow_bias), normal_bias (shadow_normal_bias)

A bias has three components: a constant toward the light, a step along the
normal, and one that grows with the slope. Each is a length at one place: so
far from the light (--at), on its axis, on a surface that leans so much
(--angle), along the map's rows or columns. What depends on neither is the same
everywhere; the rest has to be converted where it matters.

Where an engine counts in shares of its depth range or in texels, range and
texels are those of the light's map here (shadow plan shows them): an engine
that fits its maps otherwise needs other numbers.

Examples:
  shadow settings > mine.toml
  shadow measure house.glb --settings mine.toml
  shadow settings --preset bevy --kind point > bevy-point.toml
  shadow settings --convert bevy --to three
  shadow settings house.glb --convert 'bevy:depth=0.02;normal=1.8' --to three --map-size 1024
  shadow settings --convert 'three:bias=-0.0005' --to metres --of-light sun --angle 60
  shadow settings --convert godot --to bevy --light 'point:pos=0,3,0;cd=800;range=10' --at 2.5 --json";

/// Examples for `shadow completions`.
pub(super) const COMPLETIONS_EXAMPLES: &str = "\
Examples:
  shadow completions bash > ~/.local/share/bash-completion/completions/shadow
  shadow completions zsh > ~/.zfunc/_shadow          # a folder in fpath
  shadow completions fish > ~/.config/fish/completions/shadow.fish
  shadow completions powershell >> $PROFILE";

/// Examples for `shadow man`.
pub(super) const MAN_EXAMPLES: &str = "\
Examples:
  shadow man > ~/.local/share/man/man1/shadow.1
  shadow man render > ~/.local/share/man/man1/shadow-render.1
  shadow man bench | man -l -";

/// What `--show` takes, in a line.
pub(super) const SHOW_HELP: &str =
    "What to draw: color, visibility[:LIGHT], depth, shadow-map[:LIGHT[:VIEW]], or a view that explains (see --help)";

/// What `--show` takes and what its pictures mean. Both texts have brackets that a doc comment would take for links.
pub(super) const SHOW_LONG_HELP: &str = "\
What to draw: a layer of the frame, or a view that explains it

  color                the picture, in sRGB
  visibility[:LIGHT]   how much of a light reaches each pixel:
                       black is shadowed, white is lit
  depth                the distance of each pixel from the camera:
                       white is the nearest that occurs, dark grey
                       the farthest, black the background
  shadow-map[:LIGHT[:VIEW]]
                       the same as the light sees it: black is a
                       texel without a caster

Views that explain, as PNG alone (docs/gallery.md shows them all):

  mini-screen[:LIGHT[:VIEW]]
                       the picture with a shadow map in its corner
  light-view[:LIGHT[:VIEW]]
                       what the light sees, lit, at the map's size
  distance-match[:LIGHT]
                       green where the map holds the surface's own
                       distance, blue where something is nearer to the
                       light, red where what it holds is farther
  unshadowed           the picture without any shadow
  shadows              what shadows take from it
  texels[:LIGHT]       the picture under a chequered grid of texels
  bias[:LIGHT]         the bias as a length: black none, white the most
  taps[:LIGHT]         how many depth tests a pixel takes
  aliasing[:LIGHT]     over how many pixels a texel smears (m in the help
                       of shadow measure): blue 1/8 and less, white 1,
                       yellow 3, red 8 and more, dark where no light
                       arrives
  cause                why pixels are wrong, against traced truth, in
                       the colors of shadow measure

LIGHT is a light's number from 0 or its name, VIEW the number of one
of its views (a point light has six: +x -x +y -y +z -z); both are 0 if
left out. The greys of distances are logarithmic for perspective views
and linear for parallel rays.";
