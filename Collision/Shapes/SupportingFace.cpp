// The default ConvexShape::FindSupportingFace, which uses the support function alone.
#include <Fulcrum/Collision/Shapes/SupportingFace.h>

#include <bit>
#include <cmath>

namespace fulcrum {

namespace {

// Tilt of the probe directions relative to the direction, rad: faces tilted by less are found. A curved surface of
// radius R looks flat to the probes over 0.02 R, so edges shorter than a tenth of the core count as points.
constexpr float kLean = 0.02f;

// Sines of the multiples of 22.5 degrees.
constexpr float kSines[16] = {0.0f,         0.382683432f,  0.707106781f,  0.923879533f,  1.0f,          0.923879533f,
                              0.707106781f, 0.382683432f,  -0.0f,         -0.382683432f, -0.707106781f, -0.923879533f,
                              -1.0f,        -0.923879533f, -0.707106781f, -0.382683432f};

// Names a vertex by its coordinates, which are the same in every step.
int NameOf(const Vector3& v) {
    uint32_t hash = 0;
    for (int i = 0; i < 3; ++i) {
        hash = (hash ^ std::bit_cast<uint32_t>(v[i] + 0.0f)) * 0x9E3779B1u;  // + 0: the two zeros are one
        hash ^= hash >> 15;
    }
    return static_cast<int>((hash * 0x85EBCA6Bu) >> 16);
}

// The two vertices farthest from each other.
void KeepLongest(SupportingFace& face) {
    int from = 0, to = 1;
    float longest = -1;
    for (int i = 0; i < face.count; ++i) {
        for (int k = i + 1; k < face.count; ++k) {
            const float square = LengthSquared(Vector3(face.vertices[k] - face.vertices[i]));
            if (square <= longest) continue;
            longest = square;
            from = i;
            to = k;
        }
    }
    const Vector3 a = face.vertices[from], b = face.vertices[to];
    face.count = 0;
    face.Add(a, NameOf(a));
    face.Add(b, NameOf(b));
}

}  // namespace

void ConvexShape::FindSupportingFace(const Vector3& direction, SupportingFace& face) const {
    const Vector3 middle = SupportCore(direction), u = Perpendicular(direction), v = Cross<float>(direction, u);
    const float coreRadius = std::fmax(outerRadius_ - convexRadius_, 1e-3f * outerRadius_),
                apart = 5 * kLean * coreRadius;
    face.count = 0;
    for (int i = 0; i < 16; ++i) {
        const Vector3 probe = direction + u * (kLean * kSines[(i + 4) % 16]) + v * (kLean * kSines[i]);
        const Vector3 point = SupportCore(probe);
        const bool isNew =
            face.count == 0 || (LengthSquared(Vector3(point - face.vertices[face.count - 1])) > apart * apart &&
                                LengthSquared(Vector3(point - face.vertices[0])) > apart * apart);
        if (isNew) face.Add(point, NameOf(point));
    }
    if (face.count == 1) {
        face.count = 0;
        face.Add(middle, 0);
    }
    if (face.count < 3) return;

    // Newell's sum over the polygon is twice its area along the normal; an edge seen through its rounding has none.
    Vector3 sum = Vector3::Zero();
    float extent = 0;
    for (int i = 1; i + 1 < face.count; ++i) {
        const Vector3 a = face.vertices[i] - face.vertices[0], b = face.vertices[i + 1] - face.vertices[0];
        sum += Cross<float>(a, b);
        extent = std::fmax(extent, std::fmax(LengthSquared(a), LengthSquared(b)));
    }
    const float area = Length(sum);
    if (!(area > 2 * kLean * extent)) return KeepLongest(face);
    face.normal = sum * (1.0f / area);
    for (int i = 1; i < face.count; ++i) {
        const float off = Dot(face.normal, Vector3(face.vertices[i] - face.vertices[0]));
        if (std::fabs(off) > 1e-3f * coreRadius) return KeepLongest(face);
    }
    // The probed points may lie in an unrelated plane: the polygon must face the direction.
    if (Dot(face.normal, direction) < 1 - 2 * kLean * kLean) KeepLongest(face);
}

}  // namespace fulcrum
