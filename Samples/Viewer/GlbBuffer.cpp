#include <Fulcrum/Samples/Viewer/GlbBuffer.h>

#include <algorithm>

namespace fulcrum {
namespace {

constexpr int kUnsignedInt = 5125, kFloat = 5126;

}  // namespace

// All arrays have elements of 4 bytes, so that each begins at a multiple of 4.
size_t GlbBuffer::Add(const void* data, size_t size, size_t count, const char* type, Target target) {
    Json view = {{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", size}};
    if (target != Target::None) view["target"] = static_cast<int>(target);
    bytes_.append(static_cast<const char*>(data), size);
    accessors_.push_back({{"bufferView", views_.size()},
                          {"componentType", target == Target::Indices ? kUnsignedInt : kFloat},
                          {"count", count},
                          {"type", type}});
    views_.push_back(view);
    return accessors_.size() - 1;
}

size_t GlbBuffer::AddVertices(const std::vector<Vector3>& vertices) {
    static_assert(sizeof(Vector3) == 3 * sizeof(float));
    const size_t accessor =
        Add(vertices.data(), vertices.size() * sizeof(Vector3), vertices.size(), "VEC3", Target::Vertices);
    Vector3 lower = vertices.front(), upper = vertices.front();
    for (const Vector3& v : vertices) {
        lower = lower.cwiseMin(v);
        upper = upper.cwiseMax(v);
    }
    accessors_[accessor]["min"] = {lower.x(), lower.y(), lower.z()};
    accessors_[accessor]["max"] = {upper.x(), upper.y(), upper.z()};
    return accessor;
}

size_t GlbBuffer::AddIndices(const std::vector<uint32_t>& indices) {
    return Add(indices.data(), indices.size() * sizeof(uint32_t), indices.size(), "SCALAR", Target::Indices);
}

size_t GlbBuffer::AddTimes(const std::vector<float>& seconds) {
    const size_t accessor = Add(seconds.data(), seconds.size() * sizeof(float), seconds.size(), "SCALAR", Target::None);
    accessors_[accessor]["min"] = {*std::min_element(seconds.begin(), seconds.end())};
    accessors_[accessor]["max"] = {*std::max_element(seconds.begin(), seconds.end())};
    return accessor;
}

size_t GlbBuffer::AddValues(const std::vector<std::array<float, 3>>& translations) {
    return Add(translations.data(), translations.size() * sizeof(translations[0]), translations.size(), "VEC3",
               Target::None);
}

size_t GlbBuffer::AddValues(const std::vector<std::array<float, 4>>& rotations) {
    return Add(rotations.data(), rotations.size() * sizeof(rotations[0]), rotations.size(), "VEC4", Target::None);
}

}  // namespace fulcrum
