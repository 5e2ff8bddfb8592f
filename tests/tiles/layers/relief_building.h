// A building made of rectangles for tests of facades: its front is given in the frame of the wall (u right, v up, w
// outwards), turned and moved into the world.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "tiles/city/city_model.h"

namespace citystream::tiles::layers {

struct Opening {
    double u0 = 0, v0 = 0, u1 = 0, v1 = 0;
};

class ReliefBuilding {
  public:
    /// `turn`: radians, counter-clockwise; 0 faces south (-y).
    explicit ReliefBuilding(city::CityCatalog& catalog, double turn = 0, city::Vec3 corner = {100, 200, 30})
        : catalog_(catalog), cos_(std::cos(turn)), sin_(std::sin(turn)), corner_(corner) {
        object_.id = "made";
        object_.kind = city::ObjectKind::kBuilding;
    }

    uint32_t material(uint8_t r, uint8_t g, uint8_t b) { return catalog_.add_material({.rgb = {r, g, b}}); }

    using Corner = std::array<double, 3>;
    void triangle(const Corner& a, const Corner& b, const Corner& c, uint32_t material, city::SurfaceKind kind) {
        city::Triangle t;
        t.vertex = {vertex(a), vertex(b), vertex(c)};
        t.material = material;
        t.surface = kind;
        object_.triangles.push_back(t);
    }
    /// Counter-clockwise from outside.
    void quad(const Corner& a, const Corner& b, const Corner& c, const Corner& d, uint32_t material,
              city::SurfaceKind kind) {
        triangle(a, b, c, material, kind);
        triangle(a, c, d, material, kind);
    }
    void front(const Opening& o, double w, uint32_t material, city::SurfaceKind kind) {
        quad({o.u0, o.v0, w}, {o.u1, o.v0, w}, {o.u1, o.v1, w}, {o.u0, o.v1, w}, material, kind);
    }

    /// Sides, back, roof and floor behind the front: 10 triangles.
    void body(double width, double height, uint32_t material) {
        constexpr double kBack = -8;
        using city::SurfaceKind;
        quad({0, 0, kBack}, {0, 0, 0}, {0, height, 0}, {0, height, kBack}, material, SurfaceKind::kWall);
        quad({width, 0, 0}, {width, 0, kBack}, {width, height, kBack}, {width, height, 0}, material,
             SurfaceKind::kWall);
        quad({width, 0, kBack}, {0, 0, kBack}, {0, height, kBack}, {width, height, kBack}, material,
             SurfaceKind::kWall);
        quad({0, height, 0}, {width, height, 0}, {width, height, kBack}, {0, height, kBack}, material,
             SurfaceKind::kRoof);
        quad({0, 0, kBack}, {width, 0, kBack}, {width, 0, 0}, {0, 0, 0}, material, SurfaceKind::kGround);
    }

    /// The front at w = 0 with holes.
    void wall(const Opening& whole, const std::vector<Opening>& holes, uint32_t material) {
        std::set<double> us = {whole.u0, whole.u1}, vs = {whole.v0, whole.v1};
        for (const Opening& hole : holes) {
            us.insert({hole.u0, hole.u1});
            vs.insert({hole.v0, hole.v1});
        }
        for (auto u = us.begin(); std::next(u) != us.end(); ++u) {
            for (auto v = vs.begin(); std::next(v) != vs.end(); ++v) {
                const Opening cell = {*u, *v, *std::next(u), *std::next(v)};
                const bool open = std::any_of(holes.begin(), holes.end(), [&](const Opening& h) {
                    return cell.u0 >= h.u0 && cell.u1 <= h.u1 && cell.v0 >= h.v0 && cell.v1 <= h.v1;
                });
                if (!open) front(cell, 0, material, city::SurfaceKind::kWall);
            }
        }
    }

    /// Four sides from `from` back to `to`, seen from within the opening, and the pane at the back: 10 triangles.
    void window(const Opening& o, double from, double to, uint32_t reveal, uint32_t pane) {
        sides(o, to, from, reveal, city::SurfaceKind::kWindow, true);
        front(o, to, pane, city::SurfaceKind::kWindow);
    }

    /// A solid block from the plane w = from out to `to`: 10 triangles, 12 with its back.
    void block(const Opening& o, double from, double to, uint32_t material, bool with_back) {
        sides(o, from, to, material, city::SurfaceKind::kInstallation, false);
        front(o, to, material, city::SurfaceKind::kInstallation);
        if (with_back) {
            quad({o.u1, o.v0, from}, {o.u0, o.v0, from}, {o.u0, o.v1, from}, {o.u1, o.v1, from}, material,
                 city::SurfaceKind::kInstallation);
        }
    }

    city::CityObject& object() { return object_; }
    city::Vec3 world(const Corner& p) const {
        return {corner_.x + cos_ * p[0] + sin_ * p[2], corner_.y + sin_ * p[0] - cos_ * p[2], corner_.z + p[1]};
    }

  private:
    void sides(const Opening& o, double low, double high, uint32_t material, city::SurfaceKind kind, bool inwards) {
        const std::array<std::array<double, 2>, 4> ring = {{{o.u0, o.v0}, {o.u1, o.v0}, {o.u1, o.v1}, {o.u0, o.v1}}};
        for (size_t k = 0; k < 4; ++k) {
            std::array<double, 2> a = ring[k], b = ring[(k + 1) % 4];
            if (inwards) std::swap(a, b);
            quad({a[0], a[1], low}, {b[0], b[1], low}, {b[0], b[1], high}, {a[0], a[1], high}, material, kind);
        }
    }

    uint32_t vertex(const Corner& p) {
        const auto [found, is_new] = index_.try_emplace(p, static_cast<uint32_t>(object_.vertices.size()));
        if (is_new) object_.vertices.push_back(world(p));
        return found->second;
    }

    city::CityCatalog& catalog_;
    double cos_, sin_;
    city::Vec3 corner_;
    city::CityObject object_;
    std::map<Corner, uint32_t> index_;
};

}  // namespace citystream::tiles::layers
