// The families of scenes, a file each: what a file adds to the lab. Registry.cpp joins them.
#pragma once

#include <Fulcrum/PerformanceTest/Accuracy/LabScene.h>

#include <vector>

namespace fulcrum::accuracy {

std::vector<LabScene> FreeMotionScenes();  // projectile, free_rotation, fast_spin
std::vector<LabScene> PendulumScenes();    // pendulum, point_pendulum
std::vector<LabScene> SlidingScenes();     // incline, friction_isotropy, slide_to_roll, rolling
std::vector<LabScene> BouncingScenes();    // restitution, bouncing_field
std::vector<LabScene> RestingScenes();     // resting_cube, weight, bins
std::vector<LabScene> DriveScenes();       // spring, motor, gear_pulley, momentum
std::vector<LabScene> LoadScenes();        // heavy_on_light, tall_stack, tiny, huge
std::vector<LabScene> ChainScenes();       // heavy_chain, long_chain
std::vector<LabScene> LinkageScenes();     // four_bar, seven_bars, stewart
std::vector<LabScene> HangingScenes();     // hung_chain, rope_of_rods, held_gyroscope, cone
std::vector<LabScene> FastScenes();        // bullet
std::vector<LabScene> PlaceScenes();       // far_away, time_step, soak
std::vector<LabScene> OverlapScenes();     // overlap, coincident
std::vector<LabScene> SurfaceScenes();     // internal_edges, thin
std::vector<LabScene> DisputeScenes();     // contradictory, singular
std::vector<LabScene> InputScenes();       // degenerate, bad_input

}  // namespace fulcrum::accuracy
