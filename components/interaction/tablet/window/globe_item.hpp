#pragma once

#include <QColor>
#include <QQmlEngine>
#include <QQuickPaintedItem>

namespace usher::tablet {

/// The globe that stands for languages, for who cannot read the word beside it.
class GlobeItem : public QQuickPaintedItem {
  Q_OBJECT
  QML_ELEMENT
  Q_PROPERTY(QColor color MEMBER color_ NOTIFY colorChanged)

 public:
  explicit GlobeItem(QQuickItem* parent = nullptr);
  void paint(QPainter* painter) override;

 signals:
  void colorChanged();

 private:
  QColor color_;
};

}  // namespace usher::tablet
