// The binary part of a glTF file and its index: arrays, each a buffer view with an accessor on it. Called by GlbWriter,
// one thread. Each function appends an array and returns the accessor's index; no array may be empty.
// Source of the rules on alignment, targets, minima and maxima: Khronos, "glTF 2.0 Specification", section 3.6.2.
#pragma once

#include <Fulcrum/Math/Vector.h>

#include <nlohmann/json.hpp>

#include <array>
#include <bit>
#include <string>
#include <vector>

namespace fulcrum {

using Json = nlohmann::ordered_json;
static_assert(std::endian::native == std::endian::little, "glTF is little-endian");

class GlbBuffer {
public:
    size_t AddVertices(const std::vector<Vector3>& vertices);
    size_t AddIndices(const std::vector<uint32_t>& indices);
    size_t AddTimes(const std::vector<float>& seconds);
    size_t AddValues(const std::vector<std::array<float, 3>>& translations);
    size_t AddValues(const std::vector<std::array<float, 4>>& rotations);

    const std::string& Bytes() const { return bytes_; }
    const Json& Views() const { return views_; }
    const Json& Accessors() const { return accessors_; }

private:
    enum class Target { None, Vertices = 34962, Indices = 34963 };
    size_t Add(const void* data, size_t size, size_t count, const char* type, Target target);

    std::string bytes_;
    Json views_ = Json::array(), accessors_ = Json::array();
};

}  // namespace fulcrum
