#include <Fulcrum/Collision/Shapes/ConvexHull.h>

#include <Fulcrum/Collision/Shapes/HullBuilder.h>
#include <Fulcrum/Collision/Shapes/Message.h>
#include <Fulcrum/Collision/Shapes/ShapeFileParts.h>
#include <Fulcrum/Collision/Shapes/SupportingFace.h>
#include <Fulcrum/Math/FloatEnvironment.h>
#include <Fulcrum/Math/Wide.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace fulcrum {
namespace {

Status CheckInput(std::span<const Vector3> points, const ConvexHullSettings& settings) {
    if (settings.maxVertices < 4 || settings.maxVertices > 255) {
        return Error{ErrorCode::OutOfRange, Message("maxVertices is %d: it must be 4 to 255", settings.maxVertices)};
    }
    if (!std::isfinite(settings.convexRadius)) {
        return Error{ErrorCode::NonFinite,
                     Message("convexRadius is %g: it must be finite", double{settings.convexRadius})};
    }
    if (settings.convexRadius < 0) {
        return Error{ErrorCode::OutOfRange,
                     Message("convexRadius is %g m: it must be 0 or larger", double{settings.convexRadius})};
    }
    for (size_t i = 0; i < points.size(); ++i) {
        if (IsFinite(points[i])) continue;
        return Error{ErrorCode::NonFinite,
                     Message("point %zu is (%g, %g, %g): coordinates must be finite", i, double{points[i].x()},
                             double{points[i].y()}, double{points[i].z()})};
    }
    return Done{};
}

// By halving: a third of the latency of a sequential loop. The order does not affect a maximum.
float LargestOf(const Wide<kLanes>& wide) {
    if constexpr (kLanes < 4) return HorizontalMax(wide);
    alignas(64) float lanes[kLanes < 4 ? 4 : kLanes];
    wide.Store(lanes);
    Wide<4> four = Wide<4>::Load(lanes);
    for (int i = 4; i < kLanes; i += 4) four = Max(four, Wide<4>::Load(lanes + i));
    const float a = Max(four[0], four[1]), b = Max(four[2], four[3]);
    return Max(a, b);
}

double DistanceToSurface(const HullMesh& mesh, const Position& inside) {
    double distance = std::numeric_limits<double>::infinity();
    for (const HullMesh::Face& face : mesh.faces) {
        distance = std::min(distance, face.offset - Dot<double>(face.normal, inside));
    }
    return distance;
}

// The hull with all planes moved inwards by `radius`, by polar duality about `center`: the planes n . x = d are the
// points n / d, and the planes of those points' hull are the vertices of the intersection.
Result<HullMesh> ShrunkHull(const HullMesh& mesh, const Position& center, double radius, int maxVertices) {
    std::vector<Position> dualPoints, vertices;
    for (const HullMesh::Face& face : mesh.faces) {
        dualPoints.push_back(face.normal * (1 / (face.offset - Dot<double>(face.normal, center) - radius)));
    }
    constexpr int unlimited = std::numeric_limits<int>::max();
    const Result<HullMesh> dual = BuildHull(dualPoints, {unlimited, unlimited, 0x1p-46});
    if (!dual) return dual.GetError();
    for (const HullMesh::Face& face : dual.Value().faces) vertices.push_back(center + face.normal * (1 / face.offset));
    return BuildHull(vertices, {.maxVertices = maxVertices});
}

}  // namespace

// Turns the builder's mesh into a shape's arrays, in floats about the center of mass.
class HullFinisher {
public:
    static Result<std::shared_ptr<const ConvexHull>> Finish(const HullMesh& mesh, const Position& center,
                                                            const MassProperties& mass, float convexRadius) {
        const std::shared_ptr<ConvexHull> hull(new ConvexHull);
        hull->mass_ = mass;
        hull->convexRadius_ = convexRadius;
        AddVertices(*hull, mesh, center);
        if (!AddFaces(*hull, mesh)) {
            return Error{ErrorCode::OutOfRange, "the convexRadius leaves a core without the center of mass"};
        }
        AddEdges(*hull);
        return std::shared_ptr<const ConvexHull>(hull);
    }

private:
    static void AddVertices(ConvexHull& hull, const HullMesh& mesh, const Position& center) {
        for (const Position& v : mesh.vertices) {
            hull.vertices_.push_back((v - center).cast<float>());
            hull.bounds_.Include(hull.vertices_.back());
            hull.outerRadius_ = std::max(hull.outerRadius_, Length(hull.vertices_.back()));
        }
        hull.outerRadius_ += hull.convexRadius_;
        hull.bounds_.lower -= Vector3::Constant(hull.convexRadius_);
        hull.bounds_.upper += Vector3::Constant(hull.convexRadius_);

        const int count = static_cast<int>(hull.vertices_.size());
        hull.paddedCount_ = (count + 15) / 16 * 16;
        for (int axis = 0; axis < 3; ++axis) {
            for (int block = 0; block < hull.paddedCount_; block += 16) {
                float* const values = hull.lanes_.emplace_back().values;
                for (int i = 0; i < 16; ++i) values[i] = hull.vertices_[block + i < count ? block + i : 0][axis];
            }
        }
    }

    // Adds the faces, with planes that support the rounded vertices. False if the center is not inside all of them.
    static bool AddFaces(ConvexHull& hull, const HullMesh& mesh) {
        float smallestOffset = std::numeric_limits<float>::infinity();
        for (const HullMesh::Face& from : mesh.faces) {
            ConvexHull::Face face{static_cast<uint16_t>(hull.indices_.size()),
                                  static_cast<uint16_t>(from.corners.cornerCount), from.normal.cast<float>(), 0};
            double offset = -std::numeric_limits<double>::infinity();
            for (const Vector3& v : hull.vertices_) {
                offset = std::max(offset, Dot<double>(face.normal.cast<double>(), v.cast<double>()));
            }
            face.offset = static_cast<float>(offset);
            smallestOffset = std::min(smallestOffset, face.offset);
            for (int i = 0; i < from.corners.cornerCount; ++i) {
                hull.indices_.push_back(static_cast<uint8_t>(mesh.indices[from.corners.firstIndex + i]));
            }
            hull.faces_.push_back(face);
        }
        const int count = static_cast<int>(hull.faces_.size());
        hull.paddedFaceCount_ = (count + 15) / 16 * 16;
        for (int axis = 0; axis < 3; ++axis) {
            for (int block = 0; block < hull.paddedFaceCount_; block += 16) {
                float* const values = hull.normalLanes_.emplace_back().values;
                for (int i = 0; i < 16; ++i) values[i] = hull.faces_[block + i < count ? block + i : 0].normal[axis];
            }
        }
        for (int block = 0; block < hull.paddedFaceCount_; block += 16) {
            float* const values = hull.normalLanes_.emplace_back().values;
            for (int i = 0; i < 16; ++i) values[i] = hull.faces_[block + i < count ? block + i : 0].offset;
        }
        hull.innerRadius_ = smallestOffset + hull.convexRadius_;
        return smallestOffset > 0;
    }

    // In the order of the first face at each edge.
    static void AddEdges(ConvexHull& hull) {
        const size_t count = hull.vertices_.size();
        std::vector<int> edgeFrom(count * count, -1);
        for (size_t f = 0; f < hull.faces_.size(); ++f) {
            const ConvexHull::Face& face = hull.faces_[f];
            for (int i = 0; i < face.cornerCount; ++i) {
                const uint8_t from = hull.indices_[face.firstIndex + i];
                const uint8_t to = hull.indices_[face.firstIndex + (i + 1) % face.cornerCount];
                const int opposite = edgeFrom[to * count + from];
                if (opposite >= 0) {
                    hull.edges_[opposite].right = static_cast<uint8_t>(f);
                    continue;
                }
                edgeFrom[from * count + to] = static_cast<int>(hull.edges_.size());
                hull.edges_.push_back({from, to, static_cast<uint8_t>(f), 0});
            }
        }
    }
};

ShapeResult ShapeFileAccess::MakeHull(const HullMesh& mesh, const MassProperties& mass, float convexRadius) {
    const Result<std::shared_ptr<const ConvexHull>> hull =
        HullFinisher::Finish(mesh, Position::Zero(), mass, convexRadius);
    if (!hull) return hull.GetError();
    return ShapePtr(hull.Value());
}

Result<std::shared_ptr<const ConvexHull>> ConvexHull::Create(std::span<const Vector3> points,
                                                             const ConvexHullSettings& settings) {
    const DefaultFloats floats;
    if (const Status status = CheckInput(points, settings); !status) return status.GetError();
    std::vector<Position> positions;
    positions.reserve(points.size());
    for (const Vector3& p : points) positions.push_back(p.cast<double>());

    const Result<HullMesh> mesh = BuildHull(positions, {.maxVertices = settings.maxVertices});
    if (!mesh) return mesh.GetError();
    const SolidMass solid = mesh.Value().Mass();
    const Result<MassProperties> mass = ToMassProperties(solid);
    if (!mass) return mass.GetError();
    if (settings.convexRadius == 0) return HullFinisher::Finish(mesh.Value(), solid.center, mass.Value(), 0);

    const double radius = settings.convexRadius, innerRadius = DistanceToSurface(mesh.Value(), solid.center);
    const Error tooLarge{
        ErrorCode::OutOfRange,
        Message("convexRadius is %g m: it must be smaller than the hull's inner radius, %g m", radius, innerRadius)};
    if (radius >= innerRadius) return tooLarge;
    const Result<HullMesh> core = ShrunkHull(mesh.Value(), solid.center, radius, settings.maxVertices);
    if (!core) return tooLarge;
    return HullFinisher::Finish(core.Value(), solid.center, mass.Value(), settings.convexRadius);
}

namespace {

// The index of the first of `count` vectors (in lanes, a multiple of kLanes, at most 256) that is farthest along
// `direction`; 0 if NaN. Finds the largest value first, then the first vector with it: the search carries no index and
// has no data-dependent branches.
size_t FirstFarthest(const float* laneX, const float* laneY, const float* laneZ, int count, const Vector3& direction) {
    using Lanes = Wide<kLanes>;
    const Lanes x(direction.x()), y(direction.y()), z(direction.z());
    alignas(64) float values[256];
    Lanes best(-std::numeric_limits<float>::infinity());
    for (int i = 0; i < count; i += kLanes) {
        const Lanes value = Lanes::Load(laneX + i) * x + Lanes::Load(laneY + i) * y + Lanes::Load(laneZ + i) * z;
        value.Store(values + i);
        best = Max(value, best);
    }
    const Lanes top(LargestOf(best));
    for (int block = 0; block < count; block += 64) {
        uint64_t isTop = 0;
        const int end = std::min(block + 64, count);
        for (int i = block; i < end; i += kLanes)
            isTop |= uint64_t{(Lanes::Load(values + i) == top).ToBits()} << (i - block);
        if (isTop != 0) return static_cast<size_t>(block + std::countr_zero(isTop));
    }
    return 0;
}

}  // namespace

ConvexHull::ConvexHull() : ConvexShape(ShapeType::ConvexHull) {}
std::span<const Vector3> ConvexHull::Vertices() const { return vertices_; }
std::span<const ConvexHull::Face> ConvexHull::Faces() const { return faces_; }
std::span<const ConvexHull::Edge> ConvexHull::Edges() const { return edges_; }
std::span<const uint8_t> ConvexHull::Indices() const { return indices_; }

ConvexHull::~ConvexHull() = default;

Vector3 ConvexHull::SupportCore(const Vector3& direction) const {
    return vertices_[FirstFarthest(LaneX(), LaneY(), LaneZ(), paddedCount_, direction)];
}

void ConvexHull::FindSupportingFace(const Vector3& direction, SupportingFace& face) const {
    // If a face has more corners than fit, evenly spread ones.
    const Face& found = faces_[FirstFarthest(NormalLaneX(), NormalLaneY(), NormalLaneZ(), paddedFaceCount_, direction)];
    const int count = std::min(static_cast<int>(found.cornerCount), SupportingFace::kMaxVertices);
    face.count = 0;
    for (int i = 0; i < count; ++i) {
        const uint8_t corner = indices_[found.firstIndex + static_cast<size_t>(i * found.cornerCount / count)];
        face.Add(vertices_[corner], corner);
    }
    face.normal = found.normal;
}

}  // namespace fulcrum
