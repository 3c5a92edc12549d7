// SPDX-License-Identifier: BSD-3-Clause
#include "holdfast/simulation/person.hpp"

#include "person_builder.hpp"

namespace holdfast::simulation {

namespace {
template <typename Value, std::size_t count>
const Value& any(const Value (&values)[count], Random& random) {
  return values[random.below(count)];
}

cv::Scalar varied(const cv::Scalar& colour, double by, Random& random) {
  const double shade = 1.0 + random.uniform(-by, by);
  cv::Scalar result;
  for (int channel = 0; channel < 3; ++channel)
    result[channel] = std::clamp(colour[channel] * shade * (1.0 + random.uniform(-0.3 * by, 0.3 * by)), 8.0, 245.0);
  return result;
}

pictures::Cloth upper_cloth(Top top, Random& random) {
  static const cv::Scalar dyes[] = {{225, 228, 230}, {205, 200, 190}, {45, 42, 40},    {110, 60, 35},  {150, 100, 60},
                                    {60, 45, 150},   {60, 90, 45},    {70, 120, 170},  {120, 70, 110}, {180, 165, 120},
                                    {90, 150, 190},  {75, 75, 78},    {130, 125, 125}, {95, 60, 60},   {50, 60, 110}};
  static const cv::Scalar inks[] = {{235, 238, 240}, {30, 30, 32},  {40, 35, 150},  {130, 70, 30},
                                    {50, 170, 215},  {70, 120, 40}, {160, 150, 150}};
  using Weave = pictures::Cloth::Weave;
  static constexpr Weave t_shirts[] = {Weave::printed, Weave::printed, Weave::striped,
                                       Weave::dotted,  Weave::plain,   Weave::plain};
  static constexpr Weave shirts[] = {Weave::plaid,  Weave::plaid, Weave::striped,
                                     Weave::dotted, Weave::plain, Weave::plain};
  static constexpr Weave pullovers[] = {Weave::knitted, Weave::knitted, Weave::striped, Weave::printed};
  static constexpr Weave jackets[] = {Weave::plain, Weave::denim, Weave::knitted};
  pictures::Cloth cloth;
  cloth.weave = top == Top::t_shirt    ? any(t_shirts, random)
                : top == Top::shirt    ? any(shirts, random)
                : top == Top::pullover ? any(pullovers, random)
                                       : any(jackets, random);
  cloth.colour = varied(any(dyes, random), 0.15, random);
  // A pattern in a colour too like its ground would not be seen.
  do cloth.second = varied(any(inks, random), 0.1, random);
  while (std::abs(pictures::brightness(cloth.second) - pictures::brightness(cloth.colour)) < 45.0);
  // What is woven in is seldom as strong as what is printed on.
  if (cloth.weave != Weave::printed) cloth.second = cloth.second * 0.75 + cloth.colour * 0.25;
  cloth.scale = random.uniform(0.8, 1.4);
  cloth.pattern = random.next();
  return cloth;
}
}  // namespace

PersonLook random_look(Random random) {
  static const cv::Scalar skins[] = {{165, 190, 228}, {150, 178, 218}, {135, 165, 208},
                                     {105, 140, 190}, {75, 108, 158},  {55, 78, 115}};
  static const cv::Scalar hairs[] = {{28, 26, 27},  {32, 36, 45},   {35, 50, 72},
                                     {55, 85, 125}, {90, 140, 180}, {140, 145, 148}};
  static const cv::Scalar trousers[] = {{45, 42, 42}, {85, 105, 125}, {120, 145, 160},
                                        {60, 65, 70}, {80, 60, 50},   {70, 85, 80}};
  static const cv::Scalar denims[] = {{120, 85, 60}, {95, 60, 42}, {150, 120, 95}, {70, 52, 45}};
  static const cv::Scalar leathers[] = {{30, 30, 32},  {40, 60, 90},  {215, 218, 220},
                                        {60, 45, 130}, {110, 70, 45}, {90, 92, 95}};
  PersonLook look;
  const bool woman = random.uniform() < 0.5;
  look.figure = woman ? random.uniform(0.75, 1.0) : random.uniform(0.0, 0.2);
  const std::uint32_t complexion = random.below(std::size(skins));
  look.skin = varied(skins[complexion], 0.05, random);
  // Dark skin goes with dark hair; grey comes seldom.
  const std::uint32_t shades = complexion >= 3 ? 2 : random.uniform() < 0.15 ? 6 : 5;
  look.hair = varied(hairs[random.below(shades)], 0.15, random);
  static constexpr HairStyle of_women[] = {HairStyle::shoulder_length, HairStyle::shoulder_length, HairStyle::bun,
                                           HairStyle::curly, HairStyle::parted};
  static constexpr HairStyle of_men[] = {HairStyle::cropped, HairStyle::parted, HairStyle::cropped,
                                         HairStyle::curly,   HairStyle::parted, HairStyle::bald};
  look.hair_style = woman ? any(of_women, random) : any(of_men, random);
  look.beard = !woman && random.uniform() < 0.35;
  look.glasses = random.uniform() < 0.3;

  static constexpr Top tops[] = {Top::t_shirt, Top::shirt, Top::t_shirt, Top::shirt, Top::pullover, Top::jacket};
  look.top = any(tops, random);
  look.top_cloth = upper_cloth(look.top, random);
  look.under_jacket = upper_cloth(Top::shirt, random);
  look.long_sleeves =
      look.top == Top::jacket || look.top == Top::pullover || (look.top == Top::shirt && random.uniform() < 0.7);
  look.tucked_in = look.top == Top::shirt && random.uniform() < 0.5;

  const double below = random.uniform();
  using Weave = pictures::Cloth::Weave;
  look.bottom = woman && below < 0.2 ? Bottom::skirt : below > 0.9 ? Bottom::shorts : Bottom::trousers;
  const bool denim = look.bottom != Bottom::skirt && random.uniform() < 0.6;
  look.bottom_cloth.weave = denim ? Weave::denim : look.bottom == Bottom::skirt ? Weave::flowered : Weave::plain;
  look.bottom_cloth.colour = varied(denim ? any(denims, random) : any(trousers, random), 0.15, random);
  look.bottom_cloth.second = varied({190, 200, 215}, 0.2, random);
  look.shoes = varied(any(leathers, random), 0.1, random);
  look.soles = random.uniform() < 0.6 ? cv::Scalar(205, 212, 215) : cv::Scalar(28, 28, 30);
  return look;
}

Object make_person(World& world, const std::string& name, const Skeleton& skeleton, const PersonLook& look,
                   Random random) {
  Object person;
  person.name = name;
  person.class_name = "person";
  PersonBuilder builder(world, person.mesh, skeleton, look, random);
  builder.trunk();
  builder.seat();
  builder.arms();
  builder.legs();
  builder.head();
  builder.hair();
  const BonePoses rest = skeleton.place(skeleton.standing());
  person.mesh.rest.assign(rest.begin(), rest.end());
  return person;
}

PersonBuilder::PersonBuilder(World& world, Mesh& mesh, const Skeleton& skeleton, const PersonLook& look, Random random)
    : world_(world),
      mesh_(mesh),
      skeleton_(skeleton),
      look_(look),
      random_(random),
      rest_(skeleton.place(skeleton.standing())),
      height_(static_cast<float>(skeleton.physique().height)),
      girth_(static_cast<float>(skeleton.physique().girth)),
      figure_(static_cast<float>(look.figure)) {}

}  // namespace holdfast::simulation
