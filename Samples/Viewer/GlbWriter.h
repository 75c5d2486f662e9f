// Writes a recording as an animated scene in binary glTF 2.0, for Blender and other viewers. Called by the runner, one
// thread at a time. A node per body, a mesh per shape and material, one animation of the bodies that moved.
// Source of the format: Khronos, "glTF 2.0 Specification", sections 3 and 4.
#pragma once

#include <Fulcrum/Math/Result.h>
#include <Fulcrum/Samples/Viewer/Recording.h>

#include <filesystem>

namespace fulcrum {

// Creates or replaces `path`: whole or not at all. Key frames that linear interpolation of their neighbors gives
// (within 0.2 mm and 0.0005 of a quaternion's component) are left out. Errors as WriteHtml; OutOfRange also if the file
// would exceed the format's 4 GiB.
Status WriteGlb(const Recording& recording, const std::filesystem::path& path);

}  // namespace fulcrum
