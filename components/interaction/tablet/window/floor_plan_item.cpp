#include "interaction/tablet/window/floor_plan_item.hpp"

#include <QLineF>
#include <QPainter>
#include <algorithm>

namespace usher::tablet {

namespace {

constexpr double kRobotReach = 0.85;  ///< of the size of text
constexpr double kEdge = 0.3;         ///< likewise, from names to the map's border

bool crosses(const QRectF& box, const QLineF& line) {
  if (box.contains(line.p1()) || box.contains(line.p2())) return true;
  const QLineF sides[] = {{box.topLeft(), box.topRight()},
                          {box.bottomLeft(), box.bottomRight()},
                          {box.topLeft(), box.bottomLeft()},
                          {box.topRight(), box.bottomRight()}};
  return std::any_of(std::begin(sides), std::end(sides), [&](const QLineF& side) {
    return side.intersects(line, nullptr) == QLineF::BoundedIntersection;
  });
}

/// Parted at the space nearest to its middle; as it is without one.
QString in_two_lines(QString name) {
  const qsizetype middle = name.size() / 2;
  const qsizetype before = name.lastIndexOf(' ', middle), after = name.indexOf(' ', middle);
  const bool near = before >= 0 && (after < 0 || middle - before <= after - middle);
  const qsizetype at = near ? before : after;
  return at < 0 ? name : name.replace(at, 1, '\n');
}

}  // namespace

FloorPlanItem::FloorPlanItem(QQuickItem* parent) : QQuickPaintedItem(parent) {
  setAntialiasing(true);
  connect(this, &FloorPlanItem::textSizeChanged, this, [this] { update(); });
}

void FloorPlanItem::set_screen(ScreenModel* screen) {
  if (screen == screen_) return;
  if (screen_ != nullptr) disconnect(screen_, nullptr, this, nullptr);
  screen_ = screen;
  if (screen_ != nullptr) {
    connect(screen_, &ScreenModel::mapChanged, this, [this] { update(); });
  }
  emit screenChanged();
  update();
}

/// A robot that stands sways a little; nothing is painted anew for that.
void FloorPlanItem::keep_off(QRectF& area, const QRectF& now) {
  const QPointF moved = now.topLeft() - area.topLeft(),
                grown = now.bottomRight() - area.bottomRight();
  if (moved.manhattanLength() + grown.manhattanLength() < text_size_ * 0.2) return;
  area = now;
  emit areasChanged();
  update();
}

void FloorPlanItem::paint(QPainter* painter) {
  labels_.clear();
  places_.clear();
  if (screen_ == nullptr || screen_->plan().empty()) return;
  const double scale = width() / screen_->plan().width;
  painter->setRenderHint(QPainter::SmoothPixmapTransform, true);
  painter->setRenderHint(QPainter::Antialiasing, true);
  painter->drawImage(QRectF(0, 0, width(), height()), screen_->building());
  const QPolygonF driven = route(scale);
  paint_route(painter, driven);
  paint_places(painter, scale, driven);
}

QPolygonF FloorPlanItem::route(double scale) const {
  QPolygonF points;
  if (screen_->view().page != Page::kJourney) return points;
  for (const auto& point : screen_->route()) {
    const auto at = screen_->plan().to_pixels(point, scale);
    points.append(QPointF(at.x(), at.y()));
  }
  return points;
}

void FloorPlanItem::paint_route(QPainter* painter, const QPolygonF& route) const {
  QPen pen(Theme::qt(kPalette.route), text_size_ * 0.18);
  pen.setCapStyle(Qt::RoundCap);
  pen.setJoinStyle(Qt::RoundJoin);
  painter->setPen(pen);
  painter->drawPolyline(route);
}

bool FloorPlanItem::free(const QRectF& box, const QPolygonF& route) const {
  const double edge = kEdge * text_size_;
  if (!QRectF(edge, edge, width() - 2 * edge, height() - 2 * edge).contains(box)) return false;
  if (box.intersects(robot_area_) || box.intersects(here_area_)) return false;
  const QRectF wide =
      box.adjusted(-text_size_ * 0.2, -text_size_ * 0.2, text_size_ * 0.2, text_size_ * 0.2);
  if (!route.isEmpty()) {  // where the robot is
    const double reach = text_size_ * kRobotReach;
    if (box.adjusted(-reach, -reach, reach, reach).contains(route.first())) return false;
  }
  for (qsizetype i = 1; i < route.size(); ++i) {
    if (crosses(wide, QLineF(route[i - 1], route[i]))) return false;
  }
  // A name on another place would be taken for that one's.
  return std::none_of(places_.begin(), places_.end(),
                      [&](const QPointF& place) { return box.contains(place); }) &&
         std::none_of(labels_.begin(), labels_.end(),
                      [&](const QRectF& other) { return other.intersects(box); });
}

/// Below the place or above it, in one line or two; else beside it.
std::optional<FloorPlanItem::Name> FloorPlanItem::room_for(const QString& name, const QPointF& at,
                                                           double radius,
                                                           const QFontMetricsF& metrics,
                                                           const QPolygonF& route) const {
  const QString parted = in_two_lines(name);
  for (const bool beside : {false, true}) {
    for (const QString& text : {beside ? parted : name, beside ? name : parted}) {
      QRectF box = metrics.boundingRect(QRectF(), Qt::AlignCenter, text).adjusted(-4, 0, 4, 0);
      const double edge = kEdge * text_size_ + 1.0;
      const double most_left = std::max(edge, width() - box.width() - edge);
      for (const double side : {1.0, -1.0}) {
        box.moveCenter(at + side * (beside ? QPointF(radius + box.width() / 2, 0)
                                           : QPointF(0, radius + box.height() / 2)));
        if (!beside) box.moveLeft(std::clamp(box.left(), edge, most_left));
        if (free(box, route)) return Name{text, box};
      }
    }
  }
  return std::nullopt;
}

void FloorPlanItem::paint_places(QPainter* painter, double scale, const QPolygonF& route) {
  QFont font = painter->font();
  font.setPixelSize(std::max(8, static_cast<int>(text_size_)));
  painter->setFont(font);
  const QFontMetricsF metrics(font);
  // The marked place is named first; of the others those whose names find room.
  std::vector<const Place*> order;
  for (const auto& place : screen_->places()) {
    order.push_back(&place);
    const auto at = screen_->plan().to_pixels(place.at, scale);
    places_.emplace_back(at.x(), at.y());
  }
  std::stable_partition(order.begin(), order.end(),
                        [&](const Place* place) { return place->name == screen_->view().place; });
  for (const Place* place : order) {
    const bool marked = place->name == screen_->view().place;
    const auto at = screen_->plan().to_pixels(place->at, scale);
    const QPointF point(at.x(), at.y());
    const double radius = text_size_ * (marked ? 0.35 : 0.12);
    painter->setPen(Qt::NoPen);
    painter->setBrush(Theme::qt(marked ? kPalette.goal : kPalette.status));
    painter->drawEllipse(point, radius, radius);
    const QString title = QString::fromStdString(place->title.empty() ? place->name : place->title);
    const auto name = room_for(title, point, radius, metrics, route);
    if (!name) continue;
    labels_.push_back(name->box);
    painter->setBrush(Theme::qt(kPalette.background));
    painter->setOpacity(0.85);
    painter->drawRoundedRect(name->box, 6, 6);
    painter->setOpacity(1.0);
    painter->setPen(Theme::qt(marked ? kPalette.goal : kPalette.text));
    painter->drawText(name->box, Qt::AlignCenter, name->text);
  }
}

}  // namespace usher::tablet
