// The polytope that EPA expands inside the Minkowski difference of a pair. A template over the pair, as GJK is. Lives
// on the stack of one call; allocates nothing.
#pragma once

#include <Fulcrum/Collision/NarrowPhase/SimplexSearch.h>

#include <cmath>
#include <cstdint>
#include <utility>

namespace fulcrum {

template <class Real>
struct PolytopeFace {
    uint8_t corners[3];  // counter-clockwise seen from outside
    Vec3<Real> normal;   // unit, outwards
    Real distance;       // of the plane from the origin
};

struct HorizonEdge {
    uint8_t from, to;
};

// Sorts the edges around the hole (the horizon) into a loop that starts with the first; false if there is more than
// one.
inline bool IsOneLoop(HorizonEdge* horizon, int count) {
    for (int i = 1; i < count; ++i) {
        int next = i;
        while (next < count && horizon[next].from != horizon[i - 1].to) ++next;
        if (next == count) return false;
        std::swap(horizon[i], horizon[next]);
    }
    return count >= 3 && horizon[count - 1].to == horizon[0].from;
}

// The polytope grows from a tetrahedron around the origin; its faces are a plain list in no particular order.
template <class Pair>
class Polytope {
public:
    using Vertex = typename Pair::Vertex;
    using Real = typename Vertex::Real;
    using Point = Vec3<Real>;
    using Face = PolytopeFace<Real>;

    bool Start(const Pair& pair, const Simplex<Vertex>& simplex, float tolerance);
    bool Add(const Vertex& vertex, float tolerance);
    const Face& ClosestFace() const;
    bool HasVertex(const Vertex& v) const;

private:
    static constexpr int kMaxVertices = 96, kMaxFaces = 192, kMaxHorizon = 96;

    bool AddFace(int i, int j, int k);
    bool GrowToTetrahedron(const Pair& pair, float tolerance);
    Vector3 FromFirst(const Vertex& v) const { return Vector3((v.w - vertices_[0].w).template cast<float>()); }

    Vertex vertices_[kMaxVertices];
    Face faces_[kMaxFaces];
    int vertexCount_ = 0;
    int faceCount_ = 0;
};

template <class Pair>
bool Polytope<Pair>::HasVertex(const Vertex& v) const {
    for (int i = 0; i < vertexCount_; ++i)
        if (vertices_[i].SameAs(v)) return true;
    return false;
}

template <class Pair>
bool Polytope<Pair>::AddFace(int i, int j, int k) {
    if (faceCount_ == kMaxFaces) return false;
    const Point& a = vertices_[i].w;
    const Point n = Cross<Real>(Point(vertices_[j].w - a), Point(vertices_[k].w - a));
    const Real length = std::sqrt(LengthSquaredOf<Real>(n));
    if (!(length > Real(1e-20f))) return false;
    Face& face = faces_[faceCount_++];
    face.corners[0] = static_cast<uint8_t>(i);
    face.corners[1] = static_cast<uint8_t>(j);
    face.corners[2] = static_cast<uint8_t>(k);
    face.normal = n * (1 / length);
    face.distance = Dot<Real>(face.normal, a);
    return true;
}

// Completes a simplex to four vertices, each as far as possible from the span of the others.
template <class Pair>
bool Polytope<Pair>::GrowToTetrahedron(const Pair& pair, float tolerance) {
    static const Vector3 kAxes[3] = {Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)};
    if (vertexCount_ == 1) {
        for (int i = 0; i < 6 && vertexCount_ == 1; ++i) {
            const Vertex v = pair.Support(i % 2 == 0 ? kAxes[i / 2] : Vector3(-kAxes[i / 2]));
            if (Length(FromFirst(v)) > tolerance) vertices_[vertexCount_++] = v;
        }
    }
    if (vertexCount_ == 2) {
        const Vector3 line = Normalized(FromFirst(vertices_[1]));
        const Vector3 side = Perpendicular(line), other = Cross<float>(line, side);
        for (int i = 0; i < 4 && vertexCount_ == 2; ++i) {
            const Vector3 direction = (i < 2 ? side : other) * (i % 2 == 0 ? 1.0f : -1.0f);
            const Vertex v = pair.Support(direction);
            if (Length(Cross<float>(line, FromFirst(v))) > tolerance) vertices_[vertexCount_++] = v;
        }
    }
    if (vertexCount_ == 3) {
        const Vector3 n = Normalized(Cross<float>(FromFirst(vertices_[1]), FromFirst(vertices_[2])));
        for (int i = 0; i < 2 && vertexCount_ == 3; ++i) {
            const Vertex v = pair.Support(i == 0 ? n : Vector3(-n));
            if (Abs(Dot(n, FromFirst(v))) > tolerance) vertices_[vertexCount_++] = v;
        }
    }
    return vertexCount_ == 4;
}

template <class Pair>
bool Polytope<Pair>::Start(const Pair& pair, const Simplex<Vertex>& simplex, float tolerance) {
    for (int i = 0; i < simplex.count; ++i) vertices_[vertexCount_++] = simplex.vertices[i];
    if (!GrowToTetrahedron(pair, tolerance)) return false;
    const Point n = Cross<Real>(Point(vertices_[1].w - vertices_[0].w), Point(vertices_[2].w - vertices_[0].w));
    if (Dot<Real>(n, Point(vertices_[3].w - vertices_[0].w)) > 0) std::swap(vertices_[1], vertices_[2]);
    if (!(AddFace(0, 1, 2) && AddFace(0, 3, 1) && AddFace(1, 3, 2) && AddFace(2, 3, 0))) return false;
    for (int i = 0; i < 4; ++i)
        if (faces_[i].distance < -tolerance) return false;  // the origin is not inside
    return true;
}

template <class Pair>
const typename Polytope<Pair>::Face& Polytope<Pair>::ClosestFace() const {
    int best = 0;
    for (int i = 1; i < faceCount_; ++i)
        if (faces_[i].distance < faces_[best].distance) best = i;
    return faces_[best];
}

// Removes the faces visible from the new vertex and connects the vertex to the horizon.
template <class Pair>
bool Polytope<Pair>::Add(const Vertex& vertex, float tolerance) {
    if (vertexCount_ == kMaxVertices) return false;
    HorizonEdge horizon[kMaxHorizon];
    int horizonCount = 0;
    const Real visible = 0.1f * tolerance;
    for (int f = faceCount_ - 1; f >= 0; --f) {
        if (Dot<Real>(faces_[f].normal, vertex.w) - faces_[f].distance <= visible) continue;
        for (int i = 0; i < 3; ++i) {
            const uint8_t from = faces_[f].corners[i], to = faces_[f].corners[i == 2 ? 0 : i + 1];
            int twin = 0;
            while (twin < horizonCount && !(horizon[twin].from == to && horizon[twin].to == from)) ++twin;
            if (twin < horizonCount) {
                horizon[twin] = horizon[--horizonCount];
            } else {
                if (horizonCount == kMaxHorizon) return false;
                horizon[horizonCount++] = {from, to};
            }
        }
        faces_[f] = faces_[--faceCount_];
    }
    if (!IsOneLoop(horizon, horizonCount)) return false;
    const int added = vertexCount_++;
    vertices_[added] = vertex;
    for (int i = 0; i < horizonCount; ++i)
        if (!AddFace(horizon[i].from, horizon[i].to, added)) return false;
    return true;
}

}  // namespace fulcrum
