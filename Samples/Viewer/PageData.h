// The binary data of the page: a JSON header, then columns of numbers, each column with one quantity of all frames,
// deflated as a whole. Called by HtmlWriter; Page/decode.js reads it.
//
//     u32 length of the header | header | states | positions | rotations | velocities | islands | contacts | joints |
//     jointStates | jointErrors | drawings | figures
//
// All numbers of a column are varints (7 bits a byte, low bits first), signed ones in zigzag. A state is stored only
// if its quantized value differs from the body's last one. Positions are predicted from the two states before,
// rotations and velocities from the one before; the stored difference is mostly 0 in a pile at rest.
// - states: per frame: number of states; per state: gap to the body before, flags (1 awake, 2 new island, 4 removed)
// - positions: per state: x y z in steps of header.positionStep meters
// - rotations: per state: x y z w in steps of 1 / kRotationSteps, of the sign nearest to the rotation before
// - velocities: per state: x y z in steps of kVelocityStep m/s
// - islands: per state with flag 2: difference to the body's last island
// - contacts: per frame of header.contactFrames: number of contacts; per contact: differences to the contact before of
//   body A, body B and point (in kContactPointSteps positionSteps), then normal, separation, and the impulse as
//   kImpulseSteps log2(1 + impulse / kImpulseUnit)
// - joints, jointStates, jointErrors: see PageJoints.h
// - drawings: see PageDrawings.h
// - figures: see PageFigures.h
//
// A body exists from its first state on. header.bodies.sensors lists the sensors, header.shapeChanges a triple of
// frame, body and shape for each change of a body's shape.
#pragma once

#include <Fulcrum/Samples/Viewer/Recording.h>

#include <string>

namespace fulcrum {

inline constexpr double kRotationSteps = 32768;
inline constexpr double kVelocityStep = 0.005;  // m/s
inline constexpr double kContactPointSteps = 10;
inline constexpr double kDrawingSteps = 10;
inline constexpr double kNormalStep = 0.002;
inline constexpr double kSeparationStep = 1e-5;  // m
inline constexpr double kImpulseSteps = 32;      // steps per factor of 2: 1 % each way
inline constexpr double kImpulseUnit = 1e-3;     // N s

// The bytes before deflating. The recording's indices must be valid.
std::string EncodePageData(const Recording& recording);

// In the zlib format, RFC 1950.
std::string Deflated(const std::string& bytes);

}  // namespace fulcrum
