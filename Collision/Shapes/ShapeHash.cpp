#include <Fulcrum/Collision/Shapes/ShapeHash.h>

#include <Fulcrum/Collision/Shapes/CompoundShape.h>
#include <Fulcrum/Collision/Shapes/ShapeFile.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Math/Hash.h>

#include <bit>

namespace fulcrum {

namespace {

uint64_t HashNumbers(uint64_t hash, const Vector3& v) {
    for (int i = 0; i < 3; ++i) hash = HashWord(hash, std::bit_cast<uint32_t>(v[i]));
    return hash;
}

uint64_t HashNumbers(uint64_t hash, const Quaternion& q) {
    for (const float x : {q.x, q.y, q.z, q.w}) hash = HashWord(hash, std::bit_cast<uint32_t>(x));
    return hash;
}

uint64_t HashCommon(const Shape& shape) {
    uint64_t hash = HashWord(kHashSeed, static_cast<uint64_t>(shape.Type()));
    const auto& [volume, centerOfMass, principalInertia, principalAxes] = shape.Mass();
    hash = HashNumbers(hash, Vector3(volume, shape.InnerRadius(), shape.OuterRadius()));
    hash = HashNumbers(HashNumbers(hash, centerOfMass), principalInertia);
    hash = HashNumbers(hash, principalAxes);
    return HashNumbers(HashNumbers(hash, shape.LocalBounds().lower), shape.LocalBounds().upper);
}

uint64_t HashCustom(const ConvexShape& shape) {
    uint64_t hash = HashWord(HashCommon(shape), std::bit_cast<uint32_t>(shape.ConvexRadius()));
    for (int x = -2; x <= 2; ++x)
        for (int y = -2; y <= 2; ++y)
            for (int z = -2; z <= 2; ++z)
                if (x != 0 || y != 0 || z != 0)
                    hash = HashNumbers(hash, shape.SupportCore(Vector3(static_cast<float>(x), static_cast<float>(y),
                                                                       static_cast<float>(z))));
    return hash;
}

// For compounds with custom children, which cannot be saved.
uint64_t HashCompound(const CompoundShape& shape) {
    uint64_t hash = HashCommon(shape);
    for (const CompoundShape::Child& child : shape.Children()) {
        if (!child.shape) continue;
        hash = HashWord(hash, ContentHash(*child.shape));
        hash = HashNumbers(HashNumbers(hash, child.pose.position), child.pose.rotation);
        hash = HashWord(hash, std::bit_cast<uint32_t>(child.density));
    }
    return hash;
}

uint64_t HashOf(const Shape& shape) {
    if (shape.Type() == ShapeType::Custom) return HashCustom(static_cast<const ConvexShape&>(shape));
    const Result<std::vector<uint8_t>> bytes = SaveShape(shape);
    if (bytes) return HashBytes(bytes.Value().data(), bytes.Value().size());
    return shape.IsCompound() ? HashCompound(static_cast<const CompoundShape&>(shape)) : HashCommon(shape);
}

}  // namespace

uint64_t ContentHash(const Shape& shape) {
    const DefaultFloats floats;
    if (shape.Type() == ShapeType::MutableCompound) return HashOf(shape);
    uint64_t hash = shape.hash_.Get();
    if (hash != 0) return hash;
    hash = HashOf(shape) | 1;  // 0 is none
    shape.hash_.Set(hash);
    return hash;
}

}  // namespace fulcrum
