// Light on the surfaces of a cell, from its lamps and windows.
#pragma once

#include "tests/support/rendering/scene.h"

namespace mapweld::rendered {

// Numbers the scene's surfaces and computes the light on each: an even part plus, from each lamp of the cell,
// power cos(emitted) cos(received) / (r^2 + 0.6 m^2), without shadows but for those of furniture on the floor.
void light_scene(Scene& scene);

}  // namespace mapweld::rendered
