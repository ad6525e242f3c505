#include "interaction/tablet/window/place_names_item.hpp"

#include <QPainter>
#include <algorithm>

namespace usher::tablet {

namespace {

/// Parted at the space nearest to its middle; as it is without one.
QString in_two_lines(QString name) {
  const qsizetype middle = name.size() / 2;
  const qsizetype before = name.lastIndexOf(' ', middle), after = name.indexOf(' ', middle);
  const bool near = before >= 0 && (after < 0 || middle - before <= after - middle);
  const qsizetype at = near ? before : after;
  return at < 0 ? name : name.replace(at, 1, '\n');
}

geometry::Point2 size_of(const QString& text, const QFontMetricsF& metrics) {
  const QRectF box = metrics.boundingRect(QRectF(), Qt::AlignCenter, text).adjusted(-3, 0, 3, 0);
  return {box.width(), box.height()};
}

}  // namespace

QRectF PlaceNamesItem::Name::box() const {
  const auto size = stands.box.sizes();
  return {stands.box.min().x(), stands.box.min().y(), size.x(), size.y()};
}

PlaceNamesItem::PlaceNamesItem(QQuickItem* parent) : QQuickPaintedItem(parent) {
  setAntialiasing(true);
  connect(this, &PlaceNamesItem::robotChanged, this, &PlaceNamesItem::place_sign);
}

void PlaceNamesItem::set_screen(ScreenModel* screen) {
  if (screen == screen_) return;
  if (screen_ != nullptr) disconnect(screen_, nullptr, this, nullptr);
  screen_ = screen;
  if (screen_ != nullptr) connect(screen_, &ScreenModel::mapChanged, this, &PlaceNamesItem::polish);
  emit screenChanged();
  polish();
}

void PlaceNamesItem::set_text_size(double size) {
  if (size == text_size_) return;
  text_size_ = size;
  emit textSizeChanged();
  polish();
}

void PlaceNamesItem::set_robot(const QPointF& robot) {
  if (robot == robot_) return;
  robot_ = robot;
  emit robotChanged();
}

void PlaceNamesItem::set_sign_size(const QSizeF& size) {
  if (size == sign_size_) return;
  sign_size_ = size;
  emit robotChanged();
}

void PlaceNamesItem::geometryChange(const QRectF& now, const QRectF& before) {
  QQuickPaintedItem::geometryChange(now, before);
  if (now.size() != before.size()) polish();
}

void PlaceNamesItem::itemChange(ItemChange change, const ItemChangeData& data) {
  QQuickPaintedItem::itemChange(change, data);
  if (change == ItemVisibleHasChanged) polish();
}

double PlaceNamesItem::scale() const { return width() / screen_->plan().width; }

QFont PlaceNamesItem::letters() const {
  QFont font;
  font.setPixelSize(std::max(8, static_cast<int>(text_size_)));
  return font;
}

std::vector<QPointF> PlaceNamesItem::places() const {
  std::vector<QPointF> points;
  for (const Place& place : screen_->places()) {
    const auto at = screen_->plan().to_pixels(place.at, scale());
    points.emplace_back(at.x(), at.y());
  }
  return points;
}

/// Before the next frame, however much has changed.
void PlaceNamesItem::updatePolish() {
  if (!isVisible()) return;
  names_.clear();
  update();
  if (screen_ == nullptr || screen_->plan().empty()) return;
  std::vector<const Place*> order;
  for (const Place& place : screen_->places()) order.push_back(&place);
  std::stable_partition(order.begin(), order.end(),
                        [&](const Place* place) { return screen_->marks(*place); });
  const QFontMetricsF metrics(letters());
  std::vector<PlaceName> wanted;
  std::vector<Name> names;
  wanted.reserve(order.size()), names.reserve(order.size());
  for (const Place* place : order) {
    const bool marked = screen_->marks(*place);
    const QString title = QString::fromStdString(place->title.empty() ? place->name : place->title);
    wanted.push_back({screen_->plan().to_pixels(place->at, scale()), dot_radius(marked, text_size_),
                      size_of(title, metrics), size_of(in_two_lines(title), metrics)});
    names.push_back({title, {}, marked});
  }
  std::vector<Box> kept_free;
  if (screen_->located() && screen_->view().page == Page::kMap) {  // where it stands as this opens
    const geometry::Point2 robot(robot_.x(), robot_.y());
    const geometry::Point2 reach = geometry::Point2::Constant(0.8 * robot_reach_);
    kept_free = {Box(robot - reach, robot + reach), sign({}).box};
  }
  const auto placed = place_names(screen_->plan(), scale(), text_size_, wanted, kept_free);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (!placed[i]) continue;
    names[i].stands = *placed[i];
    if (placed[i]->two_lines) names[i].text = in_two_lines(names[i].text);
    names_.push_back(std::move(names[i]));
  }
  place_sign();
}

Sign PlaceNamesItem::sign(const std::vector<Box>& names) const {
  return sign_beside({robot_.x(), robot_.y()}, robot_reach_,
                     {sign_size_.width(), sign_size_.height()}, {width(), height()}, names,
                     sign_side_);
}

void PlaceNamesItem::place_sign() {
  std::vector<Box> boxes;
  for (const Name& name : names_) boxes.push_back(name.stands.box);
  const Sign beside = sign(boxes);
  sign_side_ = beside.side;
  const QPointF position(beside.box.min().x(), beside.box.min().y());
  if (position == sign_position_) return;
  sign_position_ = position;
  emit signPositionChanged();
}

void PlaceNamesItem::paint(QPainter* painter) {
  painter->setRenderHint(QPainter::Antialiasing, true);
  painter->setFont(letters());
  for (const Name& name : names_) {
    painter->setPen(Qt::NoPen);
    painter->setBrush(Theme::qt(kPalette.background));
    painter->setOpacity(0.85);
    painter->drawRoundedRect(name.box(), 6, 6);
    painter->setOpacity(1.0);
    painter->setPen(Theme::qt(name.marked ? kPalette.goal : kPalette.text));
    painter->drawText(name.box(), Qt::AlignCenter, name.text);
  }
}

}  // namespace usher::tablet
