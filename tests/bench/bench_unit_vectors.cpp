// Claim: unit vectors. The thesis's tables of parameterisations beside what is measured here, and what the octahedron
// folded in integers does for cities.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include "codec/mesh/octahedral.h"
#include "codec/mesh/unit_vector_theory.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/unit_vector_uses.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::mesh;
using enum UnitVectorMethod;
using enum Quantisation;

constexpr const char* kClaim =
    "Unit vectors in few bits: tables of Meyer 2012, chapter 4, as thesis_* beside what is computed and measured "
    "here.\n"
    "4.1: floats. 4.4, 4.10: compactness C (error = C 2^(-bits/2)) and bits above the optimum. 4.5-4.7: largest errors "
    "at 47 and 48 bits\n"
    "in theory and of sampled directions, reckoned in doubles, in floats, and in doubles to encode and floats to "
    "decode (the thesis's\n"
    "directions are a scanned figure's normals, ours half all over the sphere, half near the worst ones). 4.8: bits to "
    "match floats. 4.9:\n"
    "speeds over OP's (domain quantisation; unit vectors). octahedron: our codes, folded in integers on a lattice with "
    "a middle.\n"
    "fibonacci: the even spread of Keinert et al. 2015. 4.20: pixels of a highlight that differ from floats'. "
    "normal_map: directions of a\n"
    "half sphere in texels. city: face normals by area, of FILEs or a generated city; exact means off by less than "
    "10^-9 radians.";

const char* name_of(Quantisation quantisation) {
    return quantisation == kDomain ? "domain" : "range";
}

double in_degrees(double radians) {
    return radians * 180 / std::numbers::pi;
}

// Columns of the thesis's tables, domain and range each, in the order of UnitVectorMethod.
struct ThesisRow {
    double at_48[2], at_47[2];             ///< Table 4.5
    double doubles[2], singles[2];         ///< Table 4.6
    double mixed[2];                       ///< Table 4.7; PP's domain is printed with another exponent
    double compactness[2], surplus[2];     ///< Tables 4.4 and 4.10
    uint32_t half[2], single[2], full[2];  ///< Table 4.8, bits
    double encode[2], direction, unit;     ///< Table 4.9, millions a second
};
constexpr ThesisRow kThesis[] = {{{5.81e-4, 4.88e-4},
                                  {5.81e-4, 4.88e-4},
                                  {5.47e-4, 4.83e-4},
                                  {7.47e-4, 5.69e-4},
                                  {5.34e-7, 4.89e-4},
                                  {0, 0},
                                  {0, 0},
                                  {49, 49},
                                  {101, 101},
                                  {217, 217},
                                  {94, 15},
                                  250,
                                  250},
                                 {{4.13e-7, 2.92e-7},
                                  {4.13e-7, 2.92e-7},
                                  {4.03e-7, 2.89e-7},
                                  {8.28e-7, 5.36e-7},
                                  {5.84e-7, 4.38e-7},
                                  {4.90, 3.46},
                                  {2.73, 1.73},
                                  {27, 27},
                                  {53, 53},
                                  {111, 111},
                                  {80, 15},
                                  230,
                                  230},
                                 {{3.37e-7, 3.37e-7},
                                  {3.37e-7, 3.37e-7},
                                  {3.37e-7, 3.37e-7},
                                  {4.22e-7, 3.37e-7},
                                  {3.37e-7, 3.37e-7},
                                  {4.00, 4.00},
                                  {2.14, 2.14},
                                  {27, 27},
                                  {53, 53},
                                  {111, 111},
                                  {88, 20},
                                  290,
                                  120},
                                 {{3.06e-7, 2.65e-7},
                                  {3.06e-7, 2.65e-7},
                                  {2.99e-7, 2.64e-7},
                                  {4.39e-7, 2.80e-7},
                                  {3.52e-7, 2.90e-7},
                                  {3.63, 3.14},
                                  {1.86, 1.44},
                                  {27, 27},
                                  {53, 53},
                                  {111, 111},
                                  {28, 7},
                                  62,
                                  40},
                                 {{2.53e-7, 1.69e-7},
                                  {5.06e-7, 3.37e-7},
                                  {2.51e-7, 1.68e-7},
                                  {8.20e-7, 5.84e-7},
                                  {2.51e-7, 1.68e-7},
                                  {4.24, 2.83},
                                  {2.31, 1.14},
                                  {28, 26},
                                  {54, 52},
                                  {112, 110},
                                  {100, 17},
                                  210,
                                  120},
                                 {{2.92e-7, 2.92e-7},
                                  {2.92e-7, 2.92e-7},
                                  {2.91e-7, 2.91e-7},
                                  {4.95e-7, 3.44e-7},
                                  {2.91e-7, 2.91e-7},
                                  {3.46, 3.46},
                                  {1.73, 1.73},
                                  {27, 27},
                                  {53, 53},
                                  {111, 111},
                                  {110, 16},
                                  250,
                                  120},
                                 {{2.65e-7, 2.65e-7},
                                  {2.65e-7, 2.65e-7},
                                  {2.64e-7, 2.64e-7},
                                  {1.19e-4, 1.19e-4},
                                  {5.91e-7, 5.91e-7},
                                  {3.14, 3.14},
                                  {1.44, 1.44},
                                  {27, 27},
                                  {53, 53},
                                  {111, 111},
                                  {21, 4},
                                  24,
                                  24}};

const ThesisRow& thesis_of(UnitVectorMethod method) {
    return kThesis[static_cast<size_t>(method)];
}

std::array<float, 3> floats_of(const Direction& n) {
    return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
}
Direction doubles_of(const std::array<float, 3>& n) {
    return {n[0], n[1], n[2]};
}

/// Half of them all over the sphere, half near the worst directions of a method.
std::vector<Direction> directions_for(UnitVectorMethod method, size_t count) {
    std::mt19937_64 random(1);
    std::normal_distribution<double> gauss;
    std::vector<Direction> directions;
    for (size_t i = 0; i < count; ++i) {
        Direction n = {gauss(random), gauss(random), gauss(random)};
        if (i % 2 == 1) {
            const Direction worst = worst_direction(method, i % 4 == 1 ? kDomain : kRange);
            const uint64_t signs = random();
            for (size_t c = 0; c < 3; ++c) n[c] = (signs >> c & 1 ? -worst[c] : worst[c]) + 0.01 * n[c];
        }
        directions.push_back(unit_direction(n));
    }
    return directions;
}

/// Largest errors by what is reckoned in to encode and to decode.
struct Largest {
    double doubles = 0, singles = 0, mixed = 0;
};

Largest largest_of(const std::vector<Direction>& directions, const UnitVectorFormat& format,
                   Quantisation quantisation) {
    Largest largest;
    for (const Direction& n : directions) {
        const std::array<float, 3> single = floats_of(n);
        const UnitVectorCode code = encode_unit_vector(n, format, quantisation);
        const UnitVectorCode from_single = encode_unit_vector(single, format, quantisation);
        const auto grow = [](double& most, double angle) { most = std::max(most, angle); };
        grow(largest.doubles, angle_between(decode_unit_vector<double>(code, format), n));
        grow(largest.mixed, angle_between(doubles_of(decode_unit_vector<float>(code, format)), n));
        grow(largest.singles,
             angle_between(doubles_of(decode_unit_vector<float>(from_single, format)), doubles_of(single)));
    }
    return largest;
}

void floats_table(BenchProgram& program) {
    struct Format {
        const char* name;
        uint32_t mantissa, bits;
        double error, count, optimal_bits;  ///< of the thesis
    };
    constexpr Format kFormats[] = {{"half", 10, 48, 4.60e-4, 1.14e7, 23.4},
                                   {"single", 23, 96, 5.62e-8, 7.66e14, 49.4},
                                   {"double", 52, 192, 1.05e-16, 2.21e32, 107.4}};
    for (const Format& format : kFormats) {
        const double error = float_vector_error(format.mantissa);
        program.print({{"table", "4.1"},
                       {"format", format.name},
                       {"component_bits", format.bits},
                       {"error_rad", rounded(error)},
                       {"thesis_error_rad", format.error},
                       {"stored_unit_vectors_error_rad", rounded(float_unit_vector_error(format.mantissa))},
                       {"optimal_vectors", rounded(optimal_count(error))},
                       {"thesis_optimal_vectors", format.count},
                       {"optimal_bits", rounded(std::log2(optimal_count(error)))},
                       {"thesis_optimal_bits", format.optimal_bits}});
    }
    program.print({{"table", "4.3.2"},
                   {"colour_bits", 8},
                   {"lambert_error_rad", rounded(lambert_error(8))},
                   {"vectors", std::round(optimal_count(std::exp2(-8)))},
                   {"thesis_vectors", 237740}});
}

void compactness_table(BenchProgram& program) {
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        if (method == kParallel) continue;
        const ThesisRow& thesis = thesis_of(method);
        for (const Quantisation quantisation : {kDomain, kRange}) {
            const size_t column = quantisation == kRange;
            program.print({{"table", "4.4, 4.10"},
                           {"method", short_name(method)},
                           {"quantisation", name_of(quantisation)},
                           {"compactness", rounded(compactness(method, quantisation, 48))},
                           {"thesis_compactness", thesis.compactness[column]},
                           {"surplus_bits", rounded(*surplus_bits(method, quantisation))},
                           {"thesis_surplus_bits", thesis.surplus[column]},
                           {"surplus_bits_over_covering", rounded(*surplus_bits_over_covering(method, quantisation))}});
        }
    }
}

void largest_errors_table(BenchProgram& program) {
    constexpr size_t kDirections = 400'000;
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        const std::vector<Direction> directions = directions_for(method, kDirections);
        const ThesisRow& thesis = thesis_of(method);
        for (const Quantisation quantisation : {kDomain, kRange}) {
            const size_t column = quantisation == kRange;
            const UnitVectorFormat at_48 = *format_of_budget(method, 48), at_47 = *format_of_budget(method, 47);
            const double bound = largest_error(method, quantisation, lattice_step(at_48));
            const Largest seen = largest_of(directions, at_48, quantisation);
            program.print({{"table", "4.5-4.7"},
                           {"method", short_name(method)},
                           {"quantisation", name_of(quantisation)},
                           {"theory_48_bits_rad", rounded(bound)},
                           {"thesis_theory_48_bits_rad", thesis.at_48[column]},
                           {"theory_47_bits_rad", rounded(largest_error(method, quantisation, lattice_step(at_47)))},
                           {"thesis_theory_47_bits_rad", thesis.at_47[column]},
                           {"doubles_rad", rounded(seen.doubles)},
                           {"thesis_doubles_rad", thesis.doubles[column]},
                           {"floats_rad", rounded(seen.singles)},
                           {"thesis_floats_rad", thesis.singles[column]},
                           {"doubles_to_floats_rad", rounded(seen.mixed)},
                           {"thesis_doubles_to_floats_rad", thesis.mixed[column]}});
            program.check(seen.doubles <= bound * 1.005, std::string(short_name(method)) + " keeps its bound");
        }
    }
}

void octahedron_table(BenchProgram& program) {
    const std::vector<Direction> directions = directions_for(kOctahedron, 400'000);
    for (const uint32_t bits : {8U, 10U, 12U, 16U, 20U, 23U, 24U, 25U, 26U, 32U}) {
        double largest = 0, sum = 0, in_floats = 0;
        for (const Direction& n : directions) {
            const uint64_t code = pack_octahedral(n, bits);
            const double error = angle_between(unpack_octahedral(code, bits), n);
            largest = std::max(largest, error);
            sum += error;
            in_floats = std::max(in_floats, angle_between(doubles_of(unpack_octahedral_float(code, bits)), n));
        }
        const double bound = largest_error(kOctahedron, kRange, 1.0 / octahedral_side(bits));
        program.print({{"table", "octahedron"},
                       {"bits", 2 * bits},
                       {"bound_rad", rounded(bound)},
                       {"bound_degrees", rounded(in_degrees(bound))},
                       {"largest_rad", rounded(largest)},
                       {"mean_rad", rounded(sum / static_cast<double>(directions.size()))},
                       {"largest_decoded_in_floats_rad", rounded(in_floats)}});
        program.check(largest <= bound * 1.005, std::to_string(2 * bits) + " bits keep the bound");
        program.check(bits > 25 || in_floats <= bound * 1.005 + 5.1e-8, "decoding in floats adds their rounding only");
    }
}

void fibonacci_table(BenchProgram& program) {
    constexpr uint32_t kPoints = 65536;
    const std::vector<double> errors = distances_to_fibonacci(directions_for(kOctahedron, 100'000), kPoints);
    program.print(
        {{"table", "fibonacci"},
         {"bits", 16},
         {"largest_rad", rounded(*std::ranges::max_element(errors))},
         {"mean_rad", rounded(std::reduce(errors.begin(), errors.end()) / static_cast<double>(errors.size()))},
         {"optimal_rad", rounded(optimal_error(kPoints))}});
}

void bits_to_match_table(BenchProgram& program) {
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        const ThesisRow& thesis = thesis_of(method);
        for (const Quantisation quantisation : {kDomain, kRange}) {
            const size_t column = quantisation == kRange;
            const auto bits = [&](uint32_t mantissa) {
                return bits_to_match(method, quantisation, float_vector_error(mantissa));
            };
            program.print({{"table", "4.8"},
                           {"method", short_name(method)},
                           {"quantisation", name_of(quantisation)},
                           {"bits", {bits(10), bits(23), bits(52)}},
                           {"thesis_bits", {thesis.half[column], thesis.single[column], thesis.full[column]}}});
        }
    }
}

/// What is timed: a pass over the same vectors or codes.
struct Timed {
    std::string name;
    double thesis = 0;  ///< millions a second
    std::function<void()> work;
};

template <typename Encode>
Timed encoding(std::string name, double thesis, const std::vector<Direction>& directions, Encode encode) {
    return {std::move(name), thesis, [&directions, encode] {
                for (const Direction& n : directions) keep(encode(n));
            }};
}

void encode_speeds(const std::vector<Direction>& directions, int repetitions, BenchProgram& program) {
    std::vector<Timed> timed;
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        for (const Quantisation quantisation : {kDomain, kRange}) {
            const UnitVectorFormat format = *format_of_budget(method, 32);
            timed.push_back(encoding(std::string(short_name(method)) + " " + name_of(quantisation),
                                     thesis_of(method).encode[quantisation == kRange], directions,
                                     [format, quantisation](const Direction& n) {
                                         return encode_unit_vector(floats_of(n), format, quantisation);
                                     }));
        }
    }
    timed.push_back(encoding("ours, 16 bits", 0, directions, [](const Direction& n) { return pack_octahedral(n, 8); }));
    timed.push_back(
        encoding("ours, 48 bits", 0, directions, [](const Direction& n) { return pack_octahedral(n, 24); }));
    std::vector<std::function<void()>> work;
    for (const Timed& one : timed) work.push_back(one.work);
    const auto seconds = time_in_turn(work, repetitions);
    const auto reference = 2 * static_cast<size_t>(kOctahedron);
    for (size_t i = 0; i < timed.size(); ++i) {
        Json line{{"table", "4.9"}, {"encode", timed[i].name}};
        line["speed_to_op_domain"] = to_json(ratio_of(seconds[reference], seconds[i]));
        if (timed[i].thesis > 0) line["thesis_speed_to_op_domain"] = rounded(timed[i].thesis / timed[reference].thesis);
        program.print(line);
    }
}

template <typename Decode>
Timed decoding(std::string name, double thesis, const std::vector<uint64_t>& codes, Decode decode) {
    return {std::move(name), thesis, [&codes, decode] {
                for (const uint64_t code : codes) keep(decode(code));
            }};
}

void decode_speeds(const std::vector<uint64_t>& codes, int repetitions, BenchProgram& program) {
    std::vector<Timed> timed;
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        const UnitVectorFormat format = *format_of_budget(method, 32);
        timed.push_back(
            decoding(std::string(short_name(method)) + " direction", thesis_of(method).direction, codes,
                     [format](uint64_t c) { return decode_direction<float>(split_code(c, format), format); }));
        timed.push_back(
            decoding(std::string(short_name(method)) + " unit vector", thesis_of(method).unit, codes,
                     [format](uint64_t c) { return decode_unit_vector<float>(split_code(c, format), format); }));
    }
    timed.push_back(decoding("ours, 16 bits, direction", 0, codes, [](uint64_t c) { return unfold_octahedral(c, 8); }));
    timed.push_back(
        decoding("ours, 16 bits, unit vector", 0, codes, [](uint64_t c) { return unpack_octahedral_float(c, 8); }));
    timed.push_back(
        decoding("ours, 48 bits, unit vector", 0, codes, [](uint64_t c) { return unpack_octahedral_float(c, 24); }));
    std::vector<std::function<void()>> work;
    for (const Timed& one : timed) work.push_back(one.work);
    const auto seconds = time_in_turn(work, repetitions);
    const auto reference = 2 * static_cast<size_t>(kOctahedron) + 1;
    for (size_t i = 0; i < timed.size(); ++i) {
        Json line{{"table", "4.9"}, {"decode", timed[i].name}};
        line["speed_to_op_unit_vector"] = to_json(ratio_of(seconds[reference], seconds[i]));
        if (timed[i].thesis > 0)
            line["thesis_speed_to_op_unit_vector"] = rounded(timed[i].thesis / timed[reference].thesis);
        program.print(line);
    }
}

void speeds_table(int repetitions, BenchProgram& program) {
    const std::vector<Direction> directions = directions_for(kOctahedron, 4096);
    std::vector<uint64_t> codes;
    std::mt19937_64 random(2);
    for (size_t i = 0; i < directions.size(); ++i) codes.push_back(random());
    encode_speeds(directions, repetitions, program);
    decode_speeds(codes, repetitions, program);
}

void highlight_table(BenchProgram& program) {
    for (const HighlightError& error : highlight_errors()) {
        program.print({{"table", "4.20"},
                       {"format", error.format},
                       {"bits", error.bits},
                       {"pixels", error.pixels},
                       {"differ_at_8_bits", error.differ_at_8},
                       {"differ_at_13_bits", error.differ_at_13},
                       {"psnr_db", rounded(error.psnr)}});
    }
}

void normal_map_table(BenchProgram& program) {
    for (const bool gentle : {false, true}) {
        for (const TexelError& error : texel_errors(gentle)) {
            program.print({{"table", "normal_map"},
                           {"directions", gentle ? "gentle slopes" : "half sphere"},
                           {"texel", error.texel},
                           {"bytes", error.bytes},
                           {"largest_degrees", rounded(in_degrees(error.largest))},
                           {"mean_degrees", rounded(in_degrees(error.mean))},
                           {"flat_is_exact", error.flat_is_exact}});
        }
    }
}

void city_table(const std::string& name, const std::vector<Face>& faces, BenchProgram& program) {
    double area = 0, along_axes = 0, exact_bytes = 0;
    for (const Face& face : faces) {
        area += face.area;
        const auto zeros = std::ranges::count_if(face.normal, [](double c) { return std::abs(c) < 1e-9; });
        if (zeros == 2) along_axes += face.area;
    }
    for (const UnitVectorLattice lattice : {UnitVectorLattice::kEven, UnitVectorLattice::kOdd}) {
        for (const uint32_t bits : {8U, 12U, 16U}) {
            const UnitVectorFormat format = {kOctahedron, bits, lattice};
            double largest = 0, sum = 0, exact = 0;
            for (const Face& face : faces) {
                const UnitVectorCode code = encode_unit_vector(face.normal, format, kRange);
                const double error = angle_between(decode_unit_vector<double>(code, format), face.normal);
                largest = std::max(largest, error);
                sum += error * face.area;
                if (error < 1e-9) exact += face.area;
            }
            const bool odd = lattice == UnitVectorLattice::kOdd;
            if (odd && bits == 8) exact_bytes = exact;
            program.print({{"table", "city"},
                           {"city", name},
                           {"faces", faces.size()},
                           {"along_axes_percent_of_area", rounded(100 * along_axes / area)},
                           {"lattice", odd ? "odd (ours)" : "even (thesis)"},
                           {"bits", 2 * bits},
                           {"exact_percent_of_area", rounded(100 * exact / area)},
                           {"mean_degrees", rounded(in_degrees(sum / area))},
                           {"largest_degrees", rounded(in_degrees(largest))}});
        }
    }
    program.check(exact_bytes >= along_axes * (1 - 1e-9), name + ": what follows the axes is exact in 16 bits");
}

void city_tables(const BenchOptions& options, BenchProgram& program) {
    if (options.files.empty()) {
        city_table("generated:" + std::to_string(options.buildings), faces_generated(options.buildings, options.seed),
                   program);
    }
    for (const std::string& file : options.files) {
        const Result<std::vector<Face>> faces = faces_of_file(file);
        if (program.check(faces.ok(), file + " is read") && program.check(!faces->empty(), file + " has faces"))
            city_table(file, *faces, program);
    }
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_unit_vectors", kClaim, "city.city.jsonl"});
    BenchOptions options;
    options.repetitions = 5;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    floats_table(program);
    compactness_table(program);
    largest_errors_table(program);
    octahedron_table(program);
    fibonacci_table(program);
    bits_to_match_table(program);
    speeds_table(options.repetitions, program);
    highlight_table(program);
    normal_map_table(program);
    city_tables(options, program);
    return program.exit_code();
}
