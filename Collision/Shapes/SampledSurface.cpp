#include <Fulcrum/Collision/Shapes/SampledSurface.h>

#include <Fulcrum/Math/FloatEnvironment.h>

namespace fulcrum {

SampledSurface SampleSurface(const ConvexShape& shape, int divisions) {
    const DefaultFloats floats;
    SampledSurface surface;
    const int across = divisions + 1;
    surface.vertices.reserve(static_cast<size_t>(6 * across * across));
    surface.indices.reserve(static_cast<size_t>(36 * divisions * divisions));
    const float step = 2.0f / static_cast<float>(divisions);
    for (int side = 0; side < 6; ++side) {
        const int axis = side / 2;
        const float sign = side % 2 == 0 ? 1.0f : -1.0f;
        const int first = static_cast<int>(surface.vertices.size());
        for (int i = 0; i < across; ++i) {
            for (int k = 0; k < across; ++k) {
                // Not normalized, so that directions on an edge of the cube have the same bits on both of its sides.
                Vector3 direction;
                direction[axis] = sign;
                direction[(axis + 1) % 3] = sign * (i == divisions ? 1.0f : static_cast<float>(i) * step - 1);
                direction[(axis + 2) % 3] = k == divisions ? 1.0f : static_cast<float>(k) * step - 1;
                surface.vertices.push_back(shape.Support(direction));
            }
        }
        for (int i = 0; i < divisions; ++i) {
            for (int k = 0; k < divisions; ++k) {
                const int a = first + i * across + k, b = a + across;
                for (const int corner : {a, b, b + 1, a, b + 1, a + 1}) surface.indices.push_back(corner);
            }
        }
    }
    return surface;
}

}  // namespace fulcrum
