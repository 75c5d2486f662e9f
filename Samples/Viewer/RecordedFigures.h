// What the curves of a recording show: figures of each frame, and what the scene says of its looks. Plain data.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <cstdint>
#include <string>
#include <vector>

namespace fulcrum {

// Of the steps since the frame before: the largest of their penetrations, the means of their times; all else at the
// frame itself.
struct RecordedFigures {
    double kinetic = 0, potential = 0, springs = 0;  // J
    double momentum = 0, angularMomentum = 0;        // kg m/s, and kg m2/s about the recording's origin: sizes
    float penetration = 0;                           // m, >= 0
    uint32_t deepestA = 0, deepestB = 0;             // the bodies of that; the same where there is none
    uint32_t contacts = 0, awake = 0;
    std::vector<float> stageMs;  // wall clock, as many as Recording::stageNames
};

// How the page first shows a recording; what is not given it finds by itself.
struct RecordedView {
    std::string color;                                         // the page's name of a color mode
    Vector3 from = Vector3::Zero();                            // towards the camera
    Vector3 lower = Vector3::Zero(), upper = Vector3::Zero();  // m, the box that fills the picture
    double picture = 0.6;                                      // part of the run
    bool showsJoints = true;
    int follows = -1;                                                    // a body; -1: none
    Vector3 waterLower = Vector3::Zero(), waterUpper = Vector3::Zero();  // m, a box of water
};

struct RecordedLook {
    uint8_t look = 0;      // index into the page's list of materials, 0: the default
    int teeth = 0;         // of a gear about z
    float toothAngle = 0;  // rad
    Vector3 beltVelocity = Vector3::Zero(), beltTurning = Vector3::Zero();  // m/s, rad/s
    Vector3 beltPivot = Vector3::Zero();                                    // m, relative to Recording::origin
    friend bool operator==(const RecordedLook&, const RecordedLook&) = default;
};

}  // namespace fulcrum
